#include "scene/gpu_sky.h"

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "scene/sky.h"

namespace loom::scene {

std::optional<Texture> make_sky_texture(const Scene& scene) {
  if (!scene.sky_image) return std::nullopt;
  const SkyImage& image = *scene.sky_image;
  const int levels = std::bit_width(static_cast<unsigned int>(std::max(image.width, image.height)));
  Texture texture({.format = Format::rgba32f,
                   .width = image.width,
                   .height = image.height,
                   .mips = levels,
                   .filter = Filter::linear,
                   .wrap = Wrap::repeat},
                  "scene_sky");
  SkyImage level = image;
  for (int mip = 0; mip < levels; ++mip) {
    std::vector<glm::vec4> texels;
    texels.reserve(level.radiance.size());
    for (const glm::vec3& radiance : level.radiance) texels.emplace_back(radiance, 0);
    texture.write(std::as_bytes(std::span(texels)), mip);
    if (mip + 1 < levels) level = level.halved();
  }
  return texture;
}

}  // namespace loom::scene
