#pragma once
// A texture as a picture for the eye: which texels, which channels, how values become colours. On the CPU, so that the
// value under the cursor, the percentiles and the picture are of the same numbers.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/formats.h"

namespace loom::viewer {

enum class Channels { rgb, red, green, blue, alpha };
/// What stands out in magenta: nothing; NaN and infinity; these and what is below zero.
enum class Flag { none, not_finite, negative };

struct TextureViewSettings {
  int mip = 0;
  int slice = 0;  ///< layer of an array, or position along `axis` of a volume
  int axis = 2;   ///< of a volume: 0 x, 1 y, 2 z
  Channels channels = Channels::rgb;
  float exposure = 0;  ///< stops
  /// Percentiles of the shown values that become black and white; none: 0 and 1.
  std::optional<glm::vec2> percentiles;
  bool false_colour = false;  ///< one channel (of rgb: luminance) in magma
  bool encode = true;         ///< linear values are sRGB-encoded; display-referred ones are not
  Flag flag = Flag::negative;
  bool operator==(const TextureViewSettings&) const = default;
};

/// A box of one level's texels.
struct TexelBox {
  glm::ivec3 lower{0}, size{1};
  bool operator==(const TexelBox&) const = default;
};

/// Texels as gpu::read_region() gives them.
struct Texels {
  TextureDesc desc;
  int mip = 0;
  TexelBox box;
  std::vector<glm::vec4> values;
};

struct TextureView {
  int width = 0, height = 0;
  std::vector<std::uint32_t> rgba;           ///< row 0 at the top, R in the lowest byte
  glm::vec2 range{0, 1};                     ///< what became black and white, before exposure
  std::size_t not_finite = 0, negative = 0;  ///< texels of the slice
};

/// Size of a slice, and how many there are along the axis.
struct SliceShape {
  int width = 1, height = 1, count = 1;
};
SliceShape slice_shape(const TextureDesc& desc, int mip, int axis);
/// A whole level, and what of it a slice is made of.
TexelBox level_box(const TextureDesc& desc, int mip);
TexelBox slice_box(const TextureDesc& desc, const TextureViewSettings& settings);
/// Where in the level a pixel of the view lies, row 0 at the top. A volume seen along x shows z to the right and y
/// upwards; along y, x to the right and z upwards.
glm::ivec3 place_of(const TextureDesc& desc, const TextureViewSettings& settings, int x, int y);
/// Texel of a pixel of the view; nothing outside, or where it was not read.
std::optional<glm::vec4> texel_at(const Texels& texels, const TextureViewSettings& settings, int x, int y);
TextureView make_view(const Texels& texels, const TextureViewSettings& settings);

// Parts of it, for other pictures of the same values.
/// The channels that the view shows of `count`; a single one stands three times.
glm::vec3 shown_channels(const glm::vec4& value, Channels channels, int count);
/// What becomes black and white; sorts in part.
glm::vec2 percentile_range(std::vector<float>& values, glm::vec2 percent);
/// R in the lowest byte.
std::uint32_t colour_of(const glm::vec3& value, const TextureViewSettings& settings, glm::vec2 range);

}  // namespace loom::viewer
