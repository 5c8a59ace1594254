#pragma once
// The sky on the GPU.
#include <optional>

#include "loom/gpu.h"
#include "scene/scene.h"

namespace loom::scene {

/// What shaders/lib/sky.glsl reads as scene_sky: the sky's image, row 0 at the top, with smaller levels that hold means
/// by solid angle. None where the sky is constant.
std::optional<Texture> make_sky_texture(const Scene& scene);

}  // namespace loom::scene
