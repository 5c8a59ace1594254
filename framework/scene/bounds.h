#pragma once
// Axis-aligned boxes of what is drawn.
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

/// In metres; empty (low > high) until a point is added.
struct Box {
  glm::dvec3 low{std::numeric_limits<double>::max()};
  glm::dvec3 high{std::numeric_limits<double>::lowest()};

  void add(const glm::dvec3& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  [[nodiscard]] bool empty() const { return !(low.x <= high.x); }
  [[nodiscard]] glm::dvec3 centre() const { return empty() ? glm::dvec3(0) : .5 * (low + high); }
  [[nodiscard]] glm::dvec3 extent() const { return empty() ? glm::dvec3(0) : high - low; }
  [[nodiscard]] double diagonal() const { return glm::length(extent()); }
};

/// World boxes, one an instance, in metres; empty where it has no vertices.
LOOM_API std::vector<Box> instance_boxes(const Scene& scene);
LOOM_API Box scene_box(const Scene& scene);

}  // namespace loom::scene
