#include "texel_weights.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>

namespace field {
namespace {

constexpr double pi = std::numbers::pi;

/// Associated Legendre polynomial over sinᵐθ, without the Condon–Shortley phase: P_l^m(z)/(1−z²)^(m/2).
double legendre(int l, int m, double z) {
  double last = 0, now = 1;
  for (int k = 1; k <= m; ++k) now *= 2 * k - 1;  // P_m^m = (2m−1)!!
  for (int k = m + 1; k <= l; ++k) {
    const double next = ((2 * k - 1) * z * now - (k + m - 1) * last) / (k - m);
    last = now;
    now = next;
  }
  return now;
}

/// Re (sine false) or Im of (x + iy)ᵐ: sinᵐθ·cos mφ or sinᵐθ·sin mφ.
double azimuth(int m, bool sine, double x, double y) {
  double re = 1, im = 0;
  for (int k = 0; k < m; ++k) {
    const double next = re * x - im * y;
    im = re * y + im * x;
    re = next;
  }
  return sine ? im : re;
}

/// A(x,y) with ω = A(x1,y1) − A(x0,y1) − A(x1,y0) + A(x0,y0).
double corner_solid_angle(double x, double y) { return std::atan2(x * y, std::sqrt(x * x + y * y + 1)); }

double texel_solid_angle(int size, int t) {
  const double x = 2. * (t % size) / size - 1, y = 2. * (t / size % size) / size - 1, width = 2. / size;
  return rectangle_solid_angle(x, y, x + width, y + width);
}

constexpr double sharpness = 3;  // λ: neighbours, 63° apart, overlap at e^(−1.7) = .19

using Row = std::array<double, gaussians>;
using Matrix = std::array<Row, gaussians>;

/// Of a symmetric positive definite matrix, by Gauss and Jordan.
Matrix inverse(Matrix m) {
  Matrix result{};
  for (std::size_t i = 0; i < gaussians; ++i) result.at(i).at(i) = 1;
  for (std::size_t pivot = 0; pivot < gaussians; ++pivot) {
    const double scale = 1 / m.at(pivot).at(pivot);
    for (std::size_t k = 0; k < gaussians; ++k) {
      m.at(pivot).at(k) *= scale;
      result.at(pivot).at(k) *= scale;
    }
    for (std::size_t i = 0; i < gaussians; ++i) {
      if (i == pivot) continue;
      const double factor = m.at(i).at(pivot);
      for (std::size_t k = 0; k < gaussians; ++k) {
        m.at(i).at(k) -= factor * m.at(pivot).at(k);
        result.at(i).at(k) -= factor * result.at(pivot).at(k);
      }
    }
  }
  return result;
}

}  // namespace

double spherical_gaussian(int i, const glm::dvec3& direction) {
  constexpr double longer = .85065080835203993, shorter = .52573111211913361;  // φ/√(1+φ²), 1/√(1+φ²)
  glm::dvec3 axis(0);
  axis[(i / 4 + 1) % 3] = (i & 1) == 0 ? shorter : -shorter;
  axis[(i / 4 + 2) % 3] = (i & 2) == 0 ? longer : -longer;
  return std::exp(sharpness * (glm::dot(direction, axis) - 1));
}

std::vector<float> gaussian_weights(int size) {
  const int texels = 6 * size * size;
  const auto row = [&](int t) {
    Row values{};
    for (int i = 0; i < gaussians; ++i)
      values.at(static_cast<std::size_t>(i)) = spherical_gaussian(i, texel_direction(size, t));
    return values;
  };
  // Normal equations: (Σ_t Δω G Gᵀ)·a = Σ_t Δω G L. The products of Gaussians come from finer faces than a small
  // cube's.
  constexpr int fine = 16;
  Matrix gram{};
  for (int t = 0; t < 6 * fine * fine; ++t) {
    for (int i = 0; i < gaussians; ++i) {
      for (int k = 0; k < gaussians; ++k) {
        const glm::dvec3 w = texel_direction(fine, t);
        gram.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(k)) +=
            texel_solid_angle(fine, t) * spherical_gaussian(i, w) * spherical_gaussian(k, w);
      }
    }
  }
  const Matrix solve = inverse(gram);
  std::vector<float> weights;
  weights.reserve(static_cast<std::size_t>(texels) * gaussians);
  for (int t = 0; t < texels; ++t) {
    const Row values = row(t);
    for (const Row& solved : solve) {
      weights.push_back(static_cast<float>(texel_solid_angle(size, t) *
                                           std::inner_product(solved.begin(), solved.end(), values.begin(), 0.)));
    }
  }
  return weights;
}

double spherical_harmonic(int l, int m, const glm::dvec3& direction) {
  const int n = std::abs(m);
  double ratio = 1;  // (l−n)!/(l+n)!
  for (int k = l - n + 1; k <= l + n; ++k) ratio /= k;
  const double scale = std::sqrt((2 * l + 1) / (4 * pi) * ratio) * (n == 0 ? 1 : std::numbers::sqrt2);
  return scale * legendre(l, n, direction.z) * azimuth(n, m < 0, direction.x, direction.y);
}

double rectangle_solid_angle(double x0, double y0, double x1, double y1) {
  return corner_solid_angle(x1, y1) - corner_solid_angle(x0, y1) - corner_solid_angle(x1, y0) +
         corner_solid_angle(x0, y0);
}

glm::dvec3 texel_direction(int size, int t) {
  const int face = t / (size * size), axis = face / 2;
  const bool positive = face % 2 == 0;
  glm::dvec3 direction(0);
  direction[axis] = positive ? 1 : -1;
  direction[(axis + (positive ? 2 : 1)) % 3] = (2. * (t % size) + 1) / size - 1;
  direction[(axis + (positive ? 1 : 2)) % 3] = (2. * (t / size % size) + 1) / size - 1;
  return glm::normalize(direction);
}

std::vector<float> texel_weights(int size, int bands) {
  const int texels = 6 * size * size;
  std::vector<float> weights;
  weights.reserve(static_cast<std::size_t>(texels) * static_cast<std::size_t>(bands * bands));
  for (int t = 0; t < texels; ++t) {
    const double solid_angle = texel_solid_angle(size, t);
    const glm::dvec3 direction = texel_direction(size, t);
    for (int l = 0; l < bands; ++l) {
      for (int m = -l; m <= l; ++m) {
        weights.push_back(static_cast<float>(solid_angle * spherical_harmonic(l, m, direction)));
      }
    }
  }
  return weights;
}

}  // namespace field
