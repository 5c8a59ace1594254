#pragma once
// Descriptions of textures and buffers, and how a pass touches them. Plain data: nothing here needs OpenGL.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec2.hpp>

#include "loom/export.h"

namespace loom {

enum class Format : std::uint8_t {
  r8,
  rg8,
  rgba8,
  r16f,
  rg16f,
  rgba16f,
  r32f,
  rg32f,
  rgba32f,
  r11g11b10f,
  r32i,
  r32ui,
  rg32ui,
  rgba32ui,
  depth32f,
};
LOOM_API std::string_view to_string(Format format);
LOOM_API std::optional<Format> format_from(std::string_view name);
LOOM_API std::size_t bytes_per_texel(Format format);
LOOM_API bool is_depth(Format format);
LOOM_API bool is_integer(Format format);

enum class TextureKind : std::uint8_t { d2, d2_array, d3, cube, cube_array };
LOOM_API std::string_view to_string(TextureKind kind);
enum class Filter : std::uint8_t { nearest, linear };
enum class Wrap : std::uint8_t { clamp, repeat };

/// Two textures with equal descriptors may share storage where their lifetimes do not meet.
struct TextureDesc {
  Format format = Format::rgba16f;
  TextureKind kind = TextureKind::d2;
  int width = 1;
  int height = 1;
  int depth = 1;  ///< slices of a d3, layers of a d2_array, 6·cubes of a cube_array, 6 for a cube
  int mips = 1;
  Filter filter = Filter::nearest;
  Wrap wrap = Wrap::clamp;
  bool grey = false;  ///< sampled, a texture of one channel is (r, r, r, 1), one of two (r, r, r, g)
  bool operator==(const TextureDesc&) const = default;

  /// The same for colours of `channels` channels: with 1, of RGBA only the first is stored (`grey`). What writes it as
  /// an image declares that without a format: `writeonly uniform image2D`.
  [[nodiscard]] LOOM_API TextureDesc with_channels(int channels) const;

  static TextureDesc image(glm::ivec2 size, Format format) {
    return {.format = format, .width = size.x, .height = size.y};
  }
  static TextureDesc volume(int n, Format format, Filter filter = Filter::linear) {
    return {.format = format, .kind = TextureKind::d3, .width = n, .height = n, .depth = n, .filter = filter};
  }
  static TextureDesc layers(glm::ivec2 size, int count, Format format) {
    return {.format = format, .kind = TextureKind::d2_array, .width = size.x, .height = size.y, .depth = count};
  }
};
LOOM_API std::size_t byte_size(const TextureDesc& desc);
/// For people: `rgba16f 512x512`, `r32f 256x256 x6`, `rgba16f 32x32x32`.
LOOM_API std::string to_string(const TextureDesc& desc);

struct BufferDesc {
  std::size_t bytes = 0;
  bool operator==(const BufferDesc&) const = default;
};

/// How a pass touches a member. Barriers follow from it; what is not declared must not be touched.
enum class Access : std::uint8_t {
  sampled,           ///< texture fetch
  image_read,        ///< imageLoad
  image_write,       ///< imageStore
  image_read_write,  ///< both, and image atomics
  color,             ///< colour attachment
  depth,             ///< depth attachment
  storage_read,      ///< SSBO, read
  storage_write,     ///< SSBO, written (and read back by the same pass)
};
LOOM_API std::string_view to_string(Access access);
LOOM_API bool writes(Access access);

}  // namespace loom
