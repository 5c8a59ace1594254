#pragma once
// Where photons begin.
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "reference/embree_scene.h"
#include "reference/sampler.h"
#include "reference/sky_sampler.h"
#include "scene/scene.h"

namespace loom::reference {

struct EmittedPhoton {
  glm::vec3 origin{0}, direction{0};
  glm::vec3 flux{0};      ///< W, of one photon where one is sent out
  bool punctual = false;  ///< from a punctual light
};

/// Punctual lights, emissive triangles and sky, chosen by power.
class PhotonSources {
 public:
  /// `geometry` numbered by Lights.
  PhotonSources(const scene::Scene& scene, const EmbreeScene& geometry, const glm::dvec3& origin);

  [[nodiscard]] EmittedPhoton sample(const PathSampler& sampler) const;
  /// Sampler sets that sample() takes.
  static constexpr std::uint32_t sets = 3;
  [[nodiscard]] float diagonal() const { return diagonal_; }
  [[nodiscard]] const glm::vec3& low() const { return low_; }
  [[nodiscard]] const glm::vec3& high() const { return high_; }
  [[nodiscard]] bool dark() const { return cumulative_.empty(); }

 private:
  enum class Kind { point, spot, directional, triangle, sky };
  struct Source {
    Kind kind = Kind::point;
    glm::vec3 position{0}, direction{0}, intensity{0};
    float cos_outer = 0, inverse_range = 0;  ///< spot
    TrianglePoint triangle;
    float area = 0;
  };
  void add(const Source& source, double power);
  /// Through a disc that the scene's sphere fits in.
  void enter(EmittedPhoton& photon, const glm::vec3& direction, glm::vec2 u, const glm::vec3& flux_density) const;

  const EmbreeScene& geometry_;
  SkySampler sky_;
  std::vector<Source> sources_;
  std::vector<double> cumulative_;  ///< of the power, 0 … 1
  glm::vec3 low_{0}, high_{0};
  float diagonal_ = 0;
};

}  // namespace loom::reference
