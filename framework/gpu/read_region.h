#pragma once
// A part of a texture, read back.
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"
#include "loom/gpu.h"

namespace loom::gpu {

/// As Texture::read(), of the box of `size` texels from `lower`; z counts slices or layers. The box must lie within.
LOOM_API std::vector<glm::vec4> read_region(const Texture& texture, int mip, glm::ivec3 lower, glm::ivec3 size);

}  // namespace loom::gpu
