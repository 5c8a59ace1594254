#include "measure/naive_flip.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <glm/common.hpp>

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;

/// White of the Rec.709 matrix below: its row sums.
constexpr glm::dvec3 white(.9504285453771808, 1, 1.0889003707981279);

glm::dvec3 xyz(glm::dvec3 c) {
  return {.4123865632529917 * c.r + .3575914909206253 * c.g + .1804504912035636 * c.b,
          .2126368216773238 * c.r + .7151829818412507 * c.g + .0721801964814255 * c.b,
          .0193306202661531 * c.r + .1191971636402084 * c.g + .9503725870054354 * c.b};
}

/// Cramer's rule on the matrix of xyz().
glm::dvec3 rgb(glm::dvec3 t) {
  const glm::dvec3 r = xyz({1, 0, 0}), g = xyz({0, 1, 0}), b = xyz({0, 0, 1});
  const auto determinant = [](glm::dvec3 u, glm::dvec3 v, glm::dvec3 w) {
    return u.x * (v.y * w.z - v.z * w.y) - v.x * (u.y * w.z - u.z * w.y) + w.x * (u.y * v.z - u.z * v.y);
  };
  const double d = determinant(r, g, b);
  return {determinant(t, g, b) / d, determinant(r, t, b) / d, determinant(r, g, t) / d};
}

glm::dvec3 ycxcz(glm::dvec3 color) {
  const glm::dvec3 n = xyz(color) / white;
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

glm::dvec3 rgb_of_ycxcz(glm::dvec3 v) {
  const double y = (v.x + 16) / 116;
  return rgb(glm::dvec3(y + v.y / 500, y, y - v.z / 200) * white);
}

glm::dvec3 hunt_lab(glm::dvec3 color) {
  const auto f = [](double t) { return t > 216. / 24389 ? std::cbrt(t) : 841. / 108 * t + 4. / 29; };
  const glm::dvec3 n = xyz(color) / white;
  const double lightness = 116 * f(n.y) - 16;
  return {lightness, .01 * lightness * 500 * (f(n.x) - f(n.y)), .01 * lightness * 200 * (f(n.y) - f(n.z))};
}

double hyab(glm::dvec3 p, glm::dvec3 q) { return std::abs(p.x - q.x) + std::hypot(p.y - q.y, p.z - q.z); }

double color_error(glm::dvec3 a, glm::dvec3 reference) {
  const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), .7);
  const double error = std::pow(hyab(hunt_lab(a), hunt_lab(reference)), .7);
  if (error < .4 * largest) return .95 / (.4 * largest) * error;
  return .95 + (error - .4 * largest) / (largest - .4 * largest) * .05;
}

/// Weights over the square −radius … radius, row by row.
struct Kernel {
  Kernel(int r, const std::function<double(int, int)>& weight) : radius(r) {
    for (int y = -r; y <= r; ++y) {
      for (int x = -r; x <= r; ++x) weights.push_back(weight(x, y));
    }
  }
  /// Positive weights sum to 1, negative ones to −1.
  Kernel& normalize() {
    double positive = 0, negative = 0;
    for (const double w : weights) (w > 0 ? positive : negative) += w;
    for (double& w : weights) w /= w > 0 ? positive : -negative;
    return *this;
  }
  int radius;
  std::vector<double> weights;
};

using Plane = std::vector<double>;
struct Size {
  int width, height;
};

double filtered(const Plane& plane, Size size, int x, int y, const Kernel& kernel) {
  double sum = 0;
  auto weight = kernel.weights.begin();
  for (int dy = -kernel.radius; dy <= kernel.radius; ++dy) {
    for (int dx = -kernel.radius; dx <= kernel.radius; ++dx) {
      const int sx = std::clamp(x + dx, 0, size.width - 1), sy = std::clamp(y + dy, 0, size.height - 1);
      sum += *weight++ *
             plane[static_cast<std::size_t>(sy) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(sx)];
    }
  }
  return sum;
}

Kernel sensitivity(double ppd, double a1, double b1, double a2, double b2) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(.04 / (2 * pi * pi)) * ppd));
  return Kernel(radius,
                [=](int x, int y) {
                  const double d2 = (x * x + y * y) / (ppd * ppd);
                  return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * d2 / b1) +
                         a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * d2 / b2);
                })
      .normalize();
}

struct Planes {
  Plane y, cx, cz, luminance;
};

Planes planes_of(const ImageLayers& image) {
  Planes p;
  for (std::size_t i = 0; i < image.channels.at("R").size(); ++i) {
    const glm::dvec3 v = ycxcz({image.channels.at("R")[i], image.channels.at("G")[i], image.channels.at("B")[i]});
    p.y.push_back(v.x);
    p.cx.push_back(v.y);
    p.cz.push_back(v.z);
    p.luminance.push_back((v.x + 16) / 116);
  }
  return p;
}

}  // namespace

double naive_flip_of_colors(glm::dvec3 a, glm::dvec3 reference) { return color_error(a, reference); }

double naive_aces(double value, double exposure) {
  const double x = .6 * value * std::exp2(exposure);
  return std::clamp((x * (2.51 * x + .03)) / (x * (2.43 * x + .59) + .14), 0., 1.);
}

std::vector<double> naive_flip(const ImageLayers& a, const ImageLayers& reference, double ppd) {
  const Size size{a.width, a.height};
  const Kernel achromatic = sensitivity(ppd, 1, .0047, 0, 1);
  const Kernel red_green = sensitivity(ppd, 1, .0053, 0, 1);
  const Kernel blue_yellow = sensitivity(ppd, 34.1, .04, 13.5, .025);
  const double sigma = .5 * .082 * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [&](int x, int y) { return std::exp(-(x * x + y * y) / (2 * sigma * sigma)); };
  const auto second = [&](int x) { return x * x / (sigma * sigma) - 1; };
  const Kernel edge_x = Kernel(radius, [&](int x, int y) { return -x * gauss(x, y); }).normalize();
  const Kernel edge_y = Kernel(radius, [&](int x, int y) { return -y * gauss(x, y); }).normalize();
  const Kernel point_x = Kernel(radius, [&](int x, int y) { return second(x) * gauss(x, y); }).normalize();
  const Kernel point_y = Kernel(radius, [&](int x, int y) { return second(y) * gauss(x, y); }).normalize();

  const Planes image = planes_of(a), truth = planes_of(reference);
  std::vector<double> error;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto seen = [&](const Planes& p) {
        return glm::clamp(rgb_of_ycxcz({filtered(p.y, size, x, y, achromatic), filtered(p.cx, size, x, y, red_green),
                                        filtered(p.cz, size, x, y, blue_yellow)}),
                          0., 1.);
      };
      const auto strength = [&](const Planes& p, const Kernel& kx, const Kernel& ky) {
        return std::hypot(filtered(p.luminance, size, x, y, kx), filtered(p.luminance, size, x, y, ky));
      };
      const double edge = std::abs(strength(image, edge_x, edge_y) - strength(truth, edge_x, edge_y));
      const double point = std::abs(strength(image, point_x, point_y) - strength(truth, point_x, point_y));
      const double feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2);
      error.push_back(std::pow(color_error(seen(image), seen(truth)), 1 - feature));
    }
  }
  return error;
}

}  // namespace loom::test
