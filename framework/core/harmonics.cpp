#include "loom/harmonics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace loom {
namespace {

constexpr double pi = std::numbers::pi;

std::size_t index_of(int l, int m) { return static_cast<std::size_t>(l * l + l + m); }

/// √((2l+1)/(4π)·(l−m)!/(l+m)!)
double normalization(int l, int m) {
  double ratio = 1;
  for (int i = l - m + 1; i <= l + m; ++i) ratio /= i;
  return std::sqrt((2 * l + 1) / (4 * pi) * ratio);
}

/// Nodes and weights of Gauss and Legendre on [−1,1], by Newton's method on the recurrence.
struct Gauss {
  std::vector<double> nodes, weights;
  explicit Gauss(int n) {
    for (int i = 0; i < n; ++i) {
      double x = std::cos(pi * (i + .75) / (n + .5)), slope = 1;
      for (int step = 0; step < 50; ++step) {
        double previous = 1, here = x;
        for (int k = 2; k <= n; ++k) {
          const double next = ((2 * k - 1) * x * here - (k - 1) * previous) / k;
          previous = here;
          here = next;
        }
        slope = n * (x * here - previous) / (x * x - 1);
        const double change = here / slope;
        x -= change;
        if (std::abs(change) < 1e-15) break;
      }
      nodes.push_back(x);
      weights.push_back(2 / ((1 - x * x) * slope * slope));
    }
  }
};

}  // namespace

std::vector<double> harmonics(const glm::dvec3& w, int order) {
  std::vector<double> result(index_of(order, order) + 1);
  // P_l^m(z)/sin^m, times the polynomials of x and y that are sin^m·cos(mφ) and sin^m·sin(mφ): nothing is singular at
  // the poles.
  double cosine = 1, sine = 0, diagonal = 1;
  for (int m = 0; m <= order; ++m) {
    double before = 0, legendre = diagonal;
    for (int l = m; l <= order; ++l) {
      if (l > m) {
        const double next = ((2 * l - 1) * w.z * legendre - (l + m - 1) * before) / (l - m);
        before = legendre;
        legendre = next;
      }
      const double scaled = (m == 0 ? 1 : std::numbers::sqrt2) * normalization(l, m) * legendre;
      result[index_of(l, m)] = scaled * cosine;
      if (m > 0) result[index_of(l, -m)] = scaled * sine;
    }
    diagonal *= 2 * m + 1;
    const double c = cosine * w.x - sine * w.y;
    sine = cosine * w.y + sine * w.x;
    cosine = c;
  }
  return result;
}

glm::dvec3 turned_about_y(const glm::dvec3& w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

std::vector<glm::dvec3> turned_about_y(const std::vector<glm::dvec3>& coefficients, double angle) {
  if (angle == 0) return coefficients;
  const int order = static_cast<int>(std::lround(std::sqrt(static_cast<double>(coefficients.size())))) - 1;
  std::vector<glm::dvec3> result(coefficients.size(), glm::dvec3(0));
  // Products of two of them are polynomials of degree 2·order: order+1 nodes along z and 2·order+1 about it are exact.
  const Gauss gauss(order + 1);
  const int around = 2 * order + 1;
  for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
    for (int k = 0; k < around; ++k) {
      const double z = gauss.nodes[i], r = std::sqrt(1 - z * z), phi = 2 * pi * k / around;
      const glm::dvec3 w(r * std::cos(phi), r * std::sin(phi), z);
      const std::vector<double> here = harmonics(w, order), there = harmonics(turned_about_y(w, angle), order);
      glm::dvec3 value(0);
      for (std::size_t j = 0; j < here.size(); ++j) value += here[j] * coefficients[j];
      value *= gauss.weights[i] * 2 * pi / around;
      for (std::size_t j = 0; j < there.size(); ++j) result[j] += there[j] * value;
    }
  }
  return result;
}

}  // namespace loom
