#include "scene/gpu_materials.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/formats.h"
#include "scene/texture.h"

namespace loom::scene {
namespace {

interop::TextureTransform transform_record(const TextureRef& ref) {
  const glm::mat3x2& m = ref.transform;
  return {.row0 = {m[0][0], m[1][0], m[2][0], ref.uv_set == 1 ? 1.F : 0.F}, .row1 = {m[0][1], m[1][1], m[2][1], 0}};
}

/// One axis of the resampling: the texels that a target texel reads, with weights that sum to 1.
struct Taps {
  int first = 0;
  std::vector<double> weights;
};

std::vector<Taps> taps_of(int from, int to) {
  std::vector<Taps> taps(static_cast<std::size_t>(to));
  const double ratio = static_cast<double>(from) / to;
  // A tent of one source texel's half-width is bilinear interpolation, a box of the ratio's width is the mean.
  for (int i = 0; i < to; ++i) {
    Taps& tap = taps[static_cast<std::size_t>(i)];
    const double lower = ratio >= 1 ? i * ratio : (i + .5) * ratio - .5;
    tap.first = static_cast<int>(std::floor(lower));
    if (ratio >= 1) {
      for (int k = tap.first; k < (i + 1) * ratio; ++k) {
        tap.weights.push_back((std::min(k + 1., (i + 1) * ratio) - std::max<double>(k, lower)) / ratio);
      }
    } else {
      const double fraction = lower - tap.first;
      tap.weights = {1 - fraction, fraction};
    }
  }
  return taps;
}

}  // namespace

std::vector<interop::Material> material_records(const Scene& scene) {
  std::vector<interop::Material> records;
  std::uint32_t layer = 0;
  for (const Material& material : scene.materials) {
    interop::Material record{};
    record.base_color = material.base_color;
    record.emissive = glm::vec4(material.emissive, material.least_alpha());
    const bool ggx = scene.surfaces == SurfaceModel::ggx;
    record.factors = {material.metallic, material.normal_scale, material.roughness, ggx ? material.transmission : 0};
    record.dielectric = {material.ior, 0, 0, 0};
    const auto flag = [&](bool on, unsigned int bit) { record.flags.x |= on ? bit : 0U; };
    const bool masked = material.alpha == AlphaMode::mask;
    flag(image_of(scene, material.base_color_texture) != nullptr, MATERIAL_BASE_COLOR_TEXTURE);
    flag(image_of(scene, material.normal_texture) != nullptr, MATERIAL_NORMAL_TEXTURE);
    flag(image_of(scene, material.emissive_texture) != nullptr, MATERIAL_EMISSIVE_TEXTURE);
    flag(image_of(scene, material.metallic_roughness_texture) != nullptr, MATERIAL_METALLIC_TEXTURE);
    flag(masked, MATERIAL_MASK);
    flag(material.double_sided, MATERIAL_DOUBLE_SIDED);
    flag(ggx && material.glossy(), MATERIAL_SPECULAR);
    flag(!material.base_color_texture.repeat_u, MATERIAL_ALPHA_CLAMP_U);
    flag(!material.base_color_texture.repeat_v, MATERIAL_ALPHA_CLAMP_V);
    record.flags.y = masked ? layer++ : 0xffffffffU;
    record.base_color_uv = transform_record(material.base_color_texture);
    record.normal_uv = transform_record(material.normal_texture);
    record.emissive_uv = transform_record(material.emissive_texture);
    record.metallic_uv = transform_record(material.metallic_roughness_texture);
    records.push_back(record);
  }
  return records;
}

glm::vec3 mean_albedo(const Scene& scene, const Material& material) {
  glm::vec3 base(material.base_color);
  if (const Image* image = image_of(scene, material.base_color_texture)) {
    const bool masked = material.alpha == AlphaMode::mask && material.base_color.a > 0;
    base *= glm::vec3(mean_texel(*image, Encoding::srgb, masked ? material.least_alpha() / material.base_color.a : 0));
  }
  float metallic = material.metallic;
  if (const Image* image = image_of(scene, material.metallic_roughness_texture)) {
    metallic *= mean_texel(*image, Encoding::linear).b;
  }
  if (scene.surfaces == SurfaceModel::ggx) base *= 1 - material.transmission;
  return base * (1 - metallic);
}

std::vector<std::uint8_t> resample_alpha(const Image& image, glm::ivec2 size) {
  const std::vector<Taps> columns = taps_of(image.width, size.x);
  const std::vector<Taps> rows = taps_of(image.height, size.y);
  const auto alpha = [&](int x, int y) {
    // Beyond the edge lies the other side: repeated textures stay seamless; clamped ones never read there.
    const int column = (x + image.width) % image.width;
    const int row = (y + image.height) % image.height;
    return image.rgba[4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(column)) +
                      3];
  };
  std::vector<std::uint8_t> layer;
  layer.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  for (const Taps& row : rows) {
    for (const Taps& column : columns) {
      double sum = 0;
      for (std::size_t j = 0; j < row.weights.size(); ++j) {
        for (std::size_t i = 0; i < column.weights.size(); ++i) {
          sum += row.weights[j] * column.weights[i] *
                 alpha(column.first + static_cast<int>(i), row.first + static_cast<int>(j));
        }
      }
      layer.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(sum, 0., 255.))));
    }
  }
  return layer;
}

std::optional<Texture> make_alpha_layers(const Scene& scene) {
  // 512² a layer bounds the memory at 256 KiB a masked material.
  constexpr int largest = 512;
  glm::ivec2 size(1);
  std::vector<const Image*> images;
  for (const Material& material : scene.materials) {
    if (material.alpha != AlphaMode::mask) continue;
    const Image* image = image_of(scene, material.base_color_texture);
    images.push_back(image);
    if (image != nullptr) size = glm::max(size, glm::min(glm::ivec2(image->width, image->height), largest));
  }
  if (images.empty()) return std::nullopt;
  std::vector<std::uint8_t> texels;
  for (const Image* image : images) {
    const std::vector<std::uint8_t> layer =
        image != nullptr
            ? resample_alpha(*image, size)
            : std::vector<std::uint8_t>(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 255);
    texels.insert(texels.end(), layer.begin(), layer.end());
  }
  TextureDesc desc = TextureDesc::layers(size, static_cast<int>(images.size()), Format::r8);
  desc.filter = Filter::linear;
  desc.wrap = Wrap::repeat;
  Texture texture(desc, "scene_alpha");
  texture.write(std::as_bytes(std::span(texels)));
  return texture;
}

}  // namespace loom::scene
