#pragma once
// The triangles that emit, as light sources to sample.
#include <vector>

#include "interop/scene.h"
#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

/// One entry for each triangle of an emissive material that emits any power: world-space corners, the mean of its
/// radiance over its area (emissive texture times alpha mask), and the cumulative share of the power of all of them, in
/// this order, the last being 1. Empty where nothing emits.
LOOM_API std::vector<interop::Emitter> build_emitters(const Scene& scene);

}  // namespace loom::scene
