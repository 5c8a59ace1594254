#pragma once
// Paths of one pixel, sixteen at a time in lockstep: one of each replicate.
#include <array>
#include <cstdint>

#include "interop/camera.h"
#include "reference/embree_scene.h"
#include "reference/film.h"
#include "reference/lights.h"
#include "reference/packet.h"
#include "reference/path_tracer.h"
#include "reference/sampler.h"

namespace loom::reference {

class Integrator {
 public:
  Integrator(const EmbreeScene& geometry, const Lights& lights, const Options& options);

  /// Samples [first, first+count) of a pixel, count ≤ 16, into samples()[0 … count).
  void trace(const interop::Camera& camera, glm::ivec2 pixel, std::uint32_t first, int count);
  [[nodiscard]] const std::array<Sample, lanes>& samples() const { return samples_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }

 private:
  struct Path {
    PathSampler sampler;
    SurfacePoint at;
    glm::vec3 weight{1};  ///< product of the albedos behind the visible surface, over roulette
    glm::vec3 direction{0};
    float density = 0;  ///< of `direction`, per solid angle
  };

  void add_punctual(int vertex);
  void add_emitters(int vertex);
  /// Chooses directions; lanes whose direction enters the surface end.
  void scatter(int vertex);
  /// Follows the directions to the next surface, adding what it and the sky emit.
  void follow(int vertex, bool last);
  [[nodiscard]] bool roulette(int lane, int vertex);
  void intersect();
  void occlude();
  void put_shadow_ray(int lane, const LightSample& light);
  [[nodiscard]] bool any_alive() const;
  [[nodiscard]] glm::vec3& emitted(int lane, int vertex);

  const EmbreeScene& geometry_;
  const Lights& lights_;
  const Options& options_;
  std::uint64_t rays_ = 0;
  std::array<Path, lanes> paths_;
  std::array<Sample, lanes> samples_;
  std::array<glm::vec3, lanes> pending_;  ///< what a lane's shadow ray brings if it is not blocked
  alignas(64) std::array<int, lanes> alive_{};
  alignas(64) std::array<int, lanes> shadow_{};
  Packet rays16_;
  ShadowPacket shadow16_;
};

}  // namespace loom::reference
