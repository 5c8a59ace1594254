#include "reference/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace loom::reference {
namespace {

std::array<float, 256> make_decode_table(Encoding encoding) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double v = static_cast<double>(i) / 255;
    // IEC 61966-2-1.
    const double linear = v <= .04045 ? v / 12.92 : std::pow((v + .055) / 1.055, 2.4);
    table[i] = static_cast<float>(encoding == Encoding::srgb ? linear : v);
  }
  return table;
}

const std::array<float, 256>& decode_table(Encoding encoding) {
  static const std::array<float, 256> linear = make_decode_table(Encoding::linear);
  static const std::array<float, 256> srgb = make_decode_table(Encoding::srgb);
  return encoding == Encoding::srgb ? srgb : linear;
}

/// `i` brought into 0 … n−1.
int wrap(int i, int n, bool repeat) {
  if (!repeat) return std::clamp(i, 0, n - 1);
  const int r = i % n;
  return r < 0 ? r + n : r;
}

/// Texel coordinate `uv·n`, bounded so that its integer part fits: coordinates beyond 2²⁴ have no fraction left anyway.
float texel_coordinate(float uv, int n, bool repeat) {
  if (!std::isfinite(uv)) return 0;
  const float inside = repeat ? uv - std::floor(uv) : std::clamp(uv, 0.F, 1.F);
  return inside * static_cast<float>(n);
}

}  // namespace

glm::vec4 sample(const scene::Image& image, const scene::TextureRef& ref, Encoding encoding, glm::vec2 uv) {
  if (image.width <= 0 || image.height <= 0) return glm::vec4(1);
  const glm::vec2 st = ref.transform * glm::vec3(uv, 1);
  const float x = texel_coordinate(st.x, image.width, ref.repeat_u);
  const float y = texel_coordinate(st.y, image.height, ref.repeat_v);
  const auto& rgb = decode_table(encoding);
  const auto& alpha = decode_table(Encoding::linear);
  const auto texel = [&](int i, int j) {
    const std::size_t row = static_cast<std::size_t>(wrap(j, image.height, ref.repeat_v));
    const std::size_t column = static_cast<std::size_t>(wrap(i, image.width, ref.repeat_u));
    const std::uint8_t* p = &image.rgba[4 * (row * static_cast<std::size_t>(image.width) + column)];
    return glm::vec4(rgb[p[0]], rgb[p[1]], rgb[p[2]], alpha[p[3]]);
  };
  if (ref.nearest) return texel(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  const float fx = std::floor(x - .5F);
  const float fy = std::floor(y - .5F);
  const int i = static_cast<int>(fx);
  const int j = static_cast<int>(fy);
  const float a = x - .5F - fx;
  const float b = y - .5F - fy;
  return glm::mix(glm::mix(texel(i, j), texel(i + 1, j), a), glm::mix(texel(i, j + 1), texel(i + 1, j + 1), a), b);
}

}  // namespace loom::reference
