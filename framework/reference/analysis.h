#pragma once
// What only rays can tell of a scene: what light reaches, how thin its walls are, how smooth light and visibility are.
#include <cstdint>
#include <optional>

#include "loom/export.h"
#include "loom/facts.h"
#include "scene/scene.h"

namespace loom::reference {

/// How closely to look; the defaults take a few seconds.
struct AnalysisOptions {
  int surface_points = 4096;  ///< light is measured on both sides of each, thickness behind
  int probes = 4;             ///< along each side of the lit box
  int face_side = 12;         ///< texels along a face of a probe's cube: 7.5° each, where band 8 has waves of 45°
};

/// Measures the scene as posed, by the path tracer and Embree. No random choice but fixed ones: the same scene, the
/// same numbers. `camera` matters for what is seen alone.
LOOM_API SceneMeasurements measure_scene(const scene::Scene& scene, const scene::Camera& camera,
                                         const AnalysisOptions& options = {});

/// The user's cache (core/data_dir.h), by content hash. A damaged or unreadable entry counts as none; a cache that
/// cannot be written is a warning. Entries are written beside and renamed: two processes may measure one scene at a
/// time.
LOOM_API std::optional<SceneMeasurements> cached_measurements(std::uint64_t content_hash);
LOOM_API void cache_measurements(std::uint64_t content_hash, const SceneMeasurements& measurements);

}  // namespace loom::reference
