#include "scene/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>

namespace loom::scene {
namespace {

using Table = std::array<float, 256>;

Table make_table(Encoding encoding) {
  Table table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double v = static_cast<double>(i) / 255;
    // IEC 61966-2-1.
    const double decoded = v <= .04045 ? v / 12.92 : std::pow((v + .055) / 1.055, 2.4);
    table[i] = static_cast<float>(encoding == Encoding::srgb ? decoded : v);
  }
  return table;
}

const Table& table_of(Encoding encoding) {
  static const Table linear = make_table(Encoding::linear);
  static const Table srgb = make_table(Encoding::srgb);
  return encoding == Encoding::srgb ? srgb : linear;
}

glm::vec4 texel(const Image& image, Encoding encoding, int x, int y) {
  const std::uint8_t* t = &image.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                           static_cast<std::size_t>(x))];
  const Table& rgb = table_of(encoding);
  return {rgb[t[0]], rgb[t[1]], rgb[t[2]], table_of(Encoding::linear)[t[3]]};
}

int wrap(int i, int n, bool repeat) { return repeat ? ((i % n) + n) % n : std::clamp(i, 0, n - 1); }

/// In texels; brought near 0 first, so that it fits an int whatever the coordinate.
float texel_coordinate(float uv, int n, bool repeat) {
  if (!std::isfinite(uv)) return 0;
  return (repeat ? uv - std::floor(uv) : std::clamp(uv, 0.F, 1.F)) * static_cast<float>(n);
}

}  // namespace

glm::vec4 sample(const Image& image, const TextureRef& ref, Encoding encoding, glm::vec2 uv) {
  const glm::vec2 st = ref.transform * glm::vec3(uv, 1);
  const float x = texel_coordinate(st.x, image.width, ref.repeat_u);
  const float y = texel_coordinate(st.y, image.height, ref.repeat_v);
  const auto at = [&](float i, float j) {
    return texel(image, encoding, wrap(static_cast<int>(i), image.width, ref.repeat_u),
                 wrap(static_cast<int>(j), image.height, ref.repeat_v));
  };
  if (ref.nearest) return at(std::floor(x), std::floor(y));
  const float i = std::floor(x - .5F);
  const float j = std::floor(y - .5F);
  const float a = x - .5F - i;
  return glm::mix(glm::mix(at(i, j), at(i + 1, j), a), glm::mix(at(i, j + 1), at(i + 1, j + 1), a), y - .5F - j);
}

glm::vec4 mean_texel(const Image& image, Encoding encoding, float min_alpha) {
  // Counting how often each of 256 values occurs is exact, and faster than decoding every texel.
  const double least = std::ceil(std::clamp(static_cast<double>(min_alpha), 0., 1.) * 255);
  std::array<std::array<std::size_t, 256>, 4> counts{};
  std::size_t texels = 0;
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    if (image.rgba[i + 3] < least) continue;
    ++texels;
    for (std::size_t channel = 0; channel < 4; ++channel) ++counts[channel][image.rgba[i + channel]];
  }
  if (texels == 0) return min_alpha > 0 ? mean_texel(image, encoding) : glm::vec4(0);
  glm::dvec4 mean(0);
  for (std::size_t channel = 0; channel < 4; ++channel) {
    const Table& table = table_of(channel == 3 ? Encoding::linear : encoding);
    for (std::size_t value = 0; value < 256; ++value) {
      mean[static_cast<glm::length_t>(channel)] +=
          static_cast<double>(counts[channel][value]) * static_cast<double>(table[value]);
    }
  }
  return {mean / static_cast<double>(texels)};
}

const Image* image_of(const Scene& scene, const TextureRef& ref) {
  if (ref.image < 0) return nullptr;
  const Image& image = scene.images[static_cast<std::size_t>(ref.image)];
  return image.width > 0 && image.height > 0 ? &image : nullptr;
}

glm::vec2 uv_of(const Primitive& primitive, const TextureRef& ref, std::size_t vertex) {
  const auto& uvs = ref.uv_set == 1 ? primitive.uv1 : primitive.uv0;
  return uvs.empty() ? glm::vec2(0) : uvs[vertex];
}

}  // namespace loom::scene
