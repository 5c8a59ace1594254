#include "measure/flicker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

namespace loom::measure {
namespace {

constexpr int points_across = 24;
/// A pixel whose depth differs by more from the point's distance shows something before it.
constexpr double same_depth = .03;

const glm::vec4& texel(const graph::ReadImage& image, int x, int y) {
  return image.texels[static_cast<std::size_t>(image.height - 1 - y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(x)];
}

/// World position of what the pixel's centre sees; y counts from the bottom.
glm::dvec3 position(const interop::Camera& camera, int x, int y, double depth) {
  const glm::dvec2 s = 2. * (glm::dvec2(x, y) + .5) * glm::dvec2(camera.size.z, camera.size.w) - 1. +
                       glm::dvec2(camera.right.w, camera.up.w);
  const glm::dvec3 across = s.x * glm::dvec3(camera.right) + s.y * glm::dvec3(camera.up);
  if (camera.eye.w > .5f) return glm::dvec3(camera.eye) + across + depth * glm::dvec3(camera.forward);
  return glm::dvec3(camera.eye) + depth * glm::normalize(glm::dvec3(camera.forward) + across);
}

double distance_to(const interop::Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 away = point - glm::dvec3(camera.eye);
  return camera.eye.w > .5f ? glm::dot(away, glm::dvec3(camera.forward)) : glm::length(away);
}

/// Irradiance at a world point as the picture shows it; nothing where the point is hidden or outside.
std::optional<double> seen_at(const interop::Camera& camera, const graph::ReadImage& depth,
                              const graph::ReadImage& irradiance, const glm::dvec3& point) {
  const glm::dvec4 clip = glm::dmat4(camera.view_proj) * glm::dvec4(point, 1);
  if (clip.w <= 0) return std::nullopt;
  const glm::dvec2 at = (.5 * glm::dvec2(clip) / clip.w + .5) * glm::dvec2(depth.width, depth.height) - .5;
  const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
  if (x < 0 || y < 0 || x + 1 >= depth.width || y + 1 >= depth.height) return std::nullopt;
  const double distance = distance_to(camera, point);
  const glm::dvec2 f = at - glm::dvec2(x, y);
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const int px = x + (i & 1), py = y + (i >> 1);
    if (std::abs(static_cast<double>(texel(depth, px, py).x) / distance - 1) > same_depth) return std::nullopt;
    sum += ((i & 1) != 0 ? f.x : 1 - f.x) * ((i >> 1) != 0 ? f.y : 1 - f.y) *
           static_cast<double>(texel(irradiance, px, py).y);
  }
  return sum;
}

}  // namespace

double flicker(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  // Orthogonal polynomials on equidistant points: 1, t, t² − mean(t²).
  double mean = 0, linear = 0, quadratic = 0, tt = 0, qq = 0, t2 = 0;
  const auto at = [&](std::size_t i) { return static_cast<double>(i) - .5 * (n - 1); };
  for (std::size_t i = 0; i < values.size(); ++i) t2 += at(i) * at(i) / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = at(i), q = t * t - t2;
    mean += values[i] / n;
    linear += t * values[i];
    quadratic += q * values[i];
    tt += t * t;
    qq += q * q;
  }
  double square = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = at(i), q = t * t - t2;
    square += std::pow(values[i] - mean - linear / tt * t - quadratic / qq * q, 2) / n;
  }
  return mean > 0 ? std::sqrt(square) / mean : 0;
}

void FlickerProbe::add(const interop::Camera& camera, const graph::ReadImage& depth,
                       const graph::ReadImage& irradiance) {
  if (frames_++ == 0) {
    for (int i = 0; i < points_across * points_across; ++i) {
      const int x = (i % points_across) * depth.width / points_across;
      const int y = (i / points_across) * depth.height / points_across;
      if (const auto seen = static_cast<double>(texel(depth, x, y).x); seen > 0) {
        points_.push_back(position(camera, x, y, seen));
      }
    }
    series_.resize(points_.size());
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (const auto value = seen_at(camera, depth, irradiance, points_[i])) series_[i].push_back(*value);
  }
}

double FlickerProbe::value() const {
  double sum = 0;
  int count = 0;
  for (const std::vector<double>& values : series_) {
    if (values.size() < frames_) continue;  // hidden at times
    sum += std::pow(flicker(values), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace loom::measure
