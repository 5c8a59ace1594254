#pragma once
// The sky as the path tracer sees it: its radiance, and directions by radiance where it is an image.
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::reference {

class LOOM_API SkySampler {
 public:
  explicit SkySampler(const scene::Scene& scene);

  /// W/(m² sr), from a unit direction.
  [[nodiscard]] glm::vec3 radiance(const glm::vec3& direction) const;
  /// It is an image: sample() and density() may be called.
  [[nodiscard]] bool directed() const { return !rows_.empty(); }
  /// A direction with density(): a texel by its share of what arrives, then evenly within its solid angle.
  [[nodiscard]] glm::vec3 sample(glm::vec2 u) const;
  /// Per solid angle, of a unit direction; its integral over the sphere is 1.
  [[nodiscard]] float density(const glm::vec3& direction) const;

 private:
  [[nodiscard]] float share(int x, int y) const;

  const scene::Scene& scene_;
  std::vector<float> rows_;     ///< cumulative shares of the rows, 0 … 1
  std::vector<float> columns_;  ///< of the texels of each row, cumulative, 0 … 1
};

}  // namespace loom::reference
