#pragma once
// Texture look-up on the CPU, as the rasteriser does it at level 0: texels are decoded, then filtered.
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

enum class Encoding { linear, srgb };  ///< of rgb; alpha is always linear

/// The image at `uv` before the reference's transform; bilinear, or nearest where the reference says so.
LOOM_API glm::vec4 sample(const Image& image, const TextureRef& ref, Encoding encoding, glm::vec2 uv);
/// The mean, decoded, over the texels whose alpha is `min_alpha` or more (over all where there are none).
LOOM_API glm::vec4 mean_texel(const Image& image, Encoding encoding, float min_alpha = 0);
/// The image that the reference names, or null where it names none or an empty one.
LOOM_API const Image* image_of(const Scene& scene, const TextureRef& ref);
/// The vertex's coordinates for this texture before its transform; (0, 0) where the primitive has none.
LOOM_API glm::vec2 uv_of(const Primitive& primitive, const TextureRef& ref, std::size_t vertex);

}  // namespace loom::scene
