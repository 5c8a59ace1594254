#pragma once
// What emits: punctual lights, emissive triangles chosen by power, the sky.
#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "reference/embree_scene.h"
#include "reference/sky_sampler.h"
#include "scene/scene.h"

namespace loom::reference {

/// Mean of the channels. Any positive weights would leave the estimates unbiased.
inline float mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3; }

/// A unit vector by cosine about the unit vector `normal`; density cos/π. Concentric map (Shirley and Chiu 1997).
glm::vec3 sample_cosine(const glm::vec3& normal, glm::vec2 u);

/// One way along which light may reach a point, and what it brings if nothing is in the way.
struct LightSample {
  glm::vec3 value{0};      ///< emitters: radiance, W/(m² sr); punctual lights: irradiance divided by their probability
  glm::vec3 direction{0};  ///< unit, towards the light
  float distance = 0;      ///< metres; infinite for sky and directional lights
  float density = 0;       ///< emitters: per solid angle; 0 = no sample
};

class Lights {
 public:
  /// Numbers the emissive triangles of `geometry`.
  Lights(const scene::Scene& scene, EmbreeScene& geometry, const glm::dvec3& origin);

  [[nodiscard]] bool has_punctual() const { return !punctual_.empty(); }
  [[nodiscard]] bool has_emitters() const { return sky_share_ > 0 || !cumulative_.empty(); }
  [[nodiscard]] glm::vec3 sky(const glm::vec3& direction) const { return sky_.radiance(direction); }

  /// One punctual light, chosen by the irradiance it would bring to `at` unblocked.
  [[nodiscard]] LightSample sample_punctual(const SurfacePoint& at, float u) const;
  /// A point of an emissive triangle, by power and area, or a direction of the sky, by cosine or by the sky's radiance.
  [[nodiscard]] LightSample sample_emitter(const SurfacePoint& at, glm::vec2 u) const;
  /// The density, per solid angle at `from`, with which sample_emitter() finds `point`, seen along `direction`.
  [[nodiscard]] float density(const glm::vec3& from, const SurfacePoint& point, const glm::vec3& direction) const;
  /// The same for the sky.
  [[nodiscard]] float sky_density(const SurfacePoint& from, const glm::vec3& direction) const;

 private:
  struct Punctual {
    scene::LightKind kind;
    glm::vec3 position, direction, intensity;
    float cos_outer, inverse_range;
  };
  struct Emitter {
    TrianglePoint triangle;
    float probability = 0;  ///< of being chosen
    float area = 0;         ///< m²
  };
  [[nodiscard]] static glm::vec3 irradiance(const Punctual& light, const SurfacePoint& at, glm::vec3& direction,
                                            float& distance);
  void add_emitters(Geometry& geometry, std::uint32_t index);
  void choose_by_power(bool sky);

  const EmbreeScene& geometry_;
  std::vector<Punctual> punctual_;
  std::vector<Emitter> emitters_;
  std::vector<float> cumulative_;  ///< of the emitters' power, 0 … 1; empty where nothing emits
  SkySampler sky_;
  float sky_share_ = 0;  ///< probability that sample_emitter() looks at the sky
};

}  // namespace loom::reference
