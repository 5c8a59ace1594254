#pragma once
// The path tracer: what every other method is measured against.
#include <cstdint>
#include <memory>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "interop/camera.h"
#include "loom/export.h"
#include "reference/film.h"
#include "scene/scene.h"

namespace loom::reference {

/// How light straight from emitters and sky is found. Both ways alone are unbiased too: tests compare them.
enum class Strategy {
  mis,    ///< both ways, weighted by the power heuristic
  light,  ///< points on emitters alone
  bsdf,   ///< cosine-sampled directions alone
};

struct Options {
  int bounces = -1;  ///< reflections before the light arrives at the visible surface; −1 = no limit
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0 = all; the image does not depend on it
  Strategy strategy = Strategy::mis;
  bool roulette = true;  ///< Russian roulette; may be off only where bounces are limited
};

/// Identifies the picture, for resuming and merging.
LOOM_API FilmIdentity identify(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size,
                               const Options& options);

/// The rays of `camera` relative to `origin`, in double before it becomes float.
LOOM_API interop::Camera view_of(const scene::Camera& camera, const scene::Scene& scene, glm::ivec2 size,
                                 const glm::dvec3& origin);
/// `camera` with its eye given relative to `origin`.
LOOM_API interop::Camera relative_to(const glm::dvec3& origin, interop::Camera camera);

class LOOM_API PathTracer {
 public:
  /// The scene must outlive the tracer. `origin` (world, metres): positions become float relative to it, so give the
  /// camera's eye. Throws Error where Embree fails.
  PathTracer(const scene::Scene& scene, const glm::dvec3& origin, Options options);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;

  /// Brings the pixels of rows [first_row, last_row) to `samples` each; those that have them are left alone.
  /// `camera`: relative to the origin. Adds the rays traced to the film.
  void accumulate(Film& film, const interop::Camera& camera, std::uint32_t samples, int first_row, int last_row) const;
  /// The same for all rows.
  void accumulate(Film& film, const interop::Camera& camera, std::uint32_t samples) const {
    accumulate(film, camera, samples, 0, film.size().y);
  }

  [[nodiscard]] const Options& options() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace loom::reference
