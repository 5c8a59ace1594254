#pragma once
// Texture look-up on the CPU, as the rasteriser does it at level 0: texels are decoded, then filtered.
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::reference {

enum class Encoding { linear, srgb };  ///< of rgb; alpha is always linear

/// The texel of `image` at `uv` before the reference's transform; bilinear, or nearest where the reference says so.
LOOM_API glm::vec4 sample(const scene::Image& image, const scene::TextureRef& ref, Encoding encoding, glm::vec2 uv);

}  // namespace loom::reference
