#pragma once
// Photon mapping: a second reference, which shares no estimator with the path tracer but how specular lobes are
// sampled. Light is traced forwards and its density estimated where it lands; straight light too.
#include <cstdint>
#include <memory>

#include "interop/camera.h"
#include "loom/export.h"
#include "reference/film.h"
#include "scene/scene.h"

namespace loom::reference {

struct PhotonOptions {
  int bounces = -1;  ///< reflections before the light arrives at the visible surface; −1 = no limit
  std::uint64_t seed = 0;
  int threads = 0;       ///< 0 = all; the image does not depend on it
  int photons = 200000;  ///< that each pass sends out
  double radius = .005;  ///< of the first pass, in diagonals of the scene
};

/// Identifies the picture: another than the path tracer's, so that the two are never added up.
LOOM_API FilmIdentity identify(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size,
                               const PhotonOptions& options);

/// Each pass is a photon map of its own: one sample of every pixel, E = Σ Φ/(πr²) over the photons within r on the
/// pixel's surface. The radius shrinks over passes, r²_{i+1} = r²_i·(i+α)/(i+1), so that noise and bias of their mean
/// both vanish (Knaus and Zwicker, "Progressive Photon Mapping: A Probabilistic Approach", TOG 30(3), 2011).
class LOOM_API PhotonMapper {
 public:
  /// The scene must outlive it. `origin` as PathTracer's. Throws Error where Embree fails.
  PhotonMapper(const scene::Scene& scene, const glm::dvec3& origin, const PhotonOptions& options);
  ~PhotonMapper();
  PhotonMapper(PhotonMapper&&) noexcept;
  PhotonMapper& operator=(PhotonMapper&&) noexcept;

  /// One pass more: which one, the film's count of samples says.
  void accumulate(Film& film, const interop::Camera& camera) const;
  /// Of pass i, metres.
  [[nodiscard]] double radius(std::uint32_t pass) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace loom::reference
