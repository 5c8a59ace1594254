#pragma once
// Paths of one pixel where surfaces are more than diffuse: sixteen at a time in lockstep, as Integrator has them.
#include <array>
#include <cstdint>

#include "interop/camera.h"
#include "reference/bsdf.h"
#include "reference/embree_scene.h"
#include "reference/film.h"
#include "reference/lights.h"
#include "reference/packet.h"
#include "reference/path_tracer.h"
#include "reference/sampler.h"

namespace loom::reference {

class SpecularIntegrator {
 public:
  SpecularIntegrator(const EmbreeScene& geometry, const Lights& lights, const Options& options);

  /// Samples [first, first+count) of a pixel, count ≤ 16, into samples()[0 … count).
  void trace(const interop::Camera& camera, glm::ivec2 pixel, std::uint32_t first, int count);
  [[nodiscard]] const std::array<Sample, lanes>& samples() const { return samples_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  /// A path carries two weights: what its light becomes at the eye, and in the irradiance of the visible surface.
  struct Path {
    PathSampler sampler;
    SurfacePoint at;
    glm::vec3 direction{0};  ///< of the ray that led to `at`
    glm::vec3 weight{1}, irradiance{1};
    float density = 0;  ///< of the direction that was sampled last; 0: light samples cannot find it
    [[nodiscard]] Bsdf bsdf() const { return {at, -direction}; }
  };
  using Paths = std::array<Path, lanes>;

  /// Follows copies of the paths from the visible surface on, there by `first` alone.
  void follow_all(Lobes first);
  [[nodiscard]] Lobes lobes_at(int vertex) const;
  void add_punctual(int vertex);
  void add_emitters(int vertex);
  void scatter(int vertex);
  void follow(int vertex, bool last);
  /// Adds light that arrives with these factors on the path's weights.
  void add(int lane, int vertex, const glm::vec3& at_eye, const glm::vec3& as_irradiance, glm::vec3& layer);
  /// Asks for what is pending, where it is anything.
  void put_shadow_ray(int lane, const LightSample& light);
  void resolve_shadows(int vertex, bool punctual);
  [[nodiscard]] bool roulette(int lane, int vertex);
  [[nodiscard]] std::uint32_t set_of(int vertex, std::uint32_t which) const;
  [[nodiscard]] bool any_alive() const;

  const EmbreeScene& geometry_;
  const Lights& lights_;
  const Options& options_;
  Lobes first_ = Lobes::diffuse;
  std::uint64_t rays_ = 0;
  Paths seen_, paths_;  ///< at the visible surface; and on their way
  std::array<Sample, lanes> samples_;
  std::array<glm::vec3, lanes> pending_, pending_irradiance_;  ///< what a shadow ray brings if nothing blocks it
  alignas(64) std::array<int, lanes> hit_{}, alive_{}, shadow_{};
  Packet rays16_;
  ShadowPacket shadow16_;
};

}  // namespace loom::reference
