#pragma once
// A run: samples until a target is met, saved every few seconds, so that a kill loses little and a second call goes on.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "interop/camera.h"
#include "loom/export.h"
#include "reference/film.h"
#include "reference/path_tracer.h"

namespace loom::reference {

/// Stops at `samples` a pixel (rounded up to whole rounds of 16), or when Film::relative_error() is under `noise`.
struct Target {
  std::optional<std::uint32_t> samples;
  std::optional<double> noise;
};

struct Progress {
  std::uint32_t samples = 0;          ///< a pixel, so far
  std::uint32_t expected = 0;         ///< a pixel, when done; an estimate where the target is noise, 0 = unknown
  double fraction = 0;                ///< of the expected work, 0 … 1
  std::optional<double> noise;        ///< relative error, once it is known
  std::uint32_t measured_at = 0;      ///< samples a pixel of which `noise` is
  double seconds = 0;                 ///< since the call
  std::optional<double> remaining_s;  ///< estimate
  double rays_per_s = 0;              ///< since the call
};

/// How often the accumulation is saved. Large ones take longer to write: saving never takes more than 1/20 of the time.
struct Checkpoint {
  std::string path;  ///< empty: not saved
  double every_s = 5;
};

/// Brings `film` to the target. `report` is called a few times a second; returning false ends the run early (saved).
LOOM_API void run(const PathTracer& tracer, Film& film, const interop::Camera& camera, const Target& target,
                  const Checkpoint& checkpoint = {}, const std::function<bool(const Progress&)>& report = {});

/// The film at `path` if there is one, else a new one. Throws BadInput where it is of another picture or another seed.
LOOM_API Film open_film(const std::string& path, glm::ivec2 size, const FilmIdentity& identity, std::uint64_t seed);

}  // namespace loom::reference
