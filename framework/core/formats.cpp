#include "loom/formats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "loom/diagnostic.h"

namespace loom {
namespace {

struct FormatInfo {
  Format format;
  std::string_view name;
  std::size_t bytes;
  bool depth = false;
  bool integer = false;
};

// In the order of the enumeration.
constexpr std::array format_table = {
    FormatInfo{Format::r8, "r8", 1},
    FormatInfo{Format::rg8, "rg8", 2},
    FormatInfo{Format::rgba8, "rgba8", 4},
    FormatInfo{Format::r16f, "r16f", 2},
    FormatInfo{Format::rg16f, "rg16f", 4},
    FormatInfo{Format::rgba16f, "rgba16f", 8},
    FormatInfo{Format::r32f, "r32f", 4},
    FormatInfo{Format::rg32f, "rg32f", 8},
    FormatInfo{Format::rgba32f, "rgba32f", 16},
    FormatInfo{Format::r11g11b10f, "r11g11b10f", 4},
    FormatInfo{Format::r32i, "r32i", 4, false, true},
    FormatInfo{Format::r32ui, "r32ui", 4, false, true},
    FormatInfo{Format::rg32ui, "rg32ui", 8, false, true},
    FormatInfo{Format::rgba32ui, "rgba32ui", 16, false, true},
    FormatInfo{Format::depth32f, "depth32f", 4, true, false},
};

constexpr bool table_in_order() {
  for (std::size_t i = 0; i < format_table.size(); ++i)
    if (static_cast<std::size_t>(format_table[i].format) != i) return false;
  return true;
}
static_assert(table_in_order());

const FormatInfo& info(Format format) { return format_table.at(static_cast<std::size_t>(format)); }

}  // namespace

std::string_view to_string(Format format) { return info(format).name; }

std::optional<Format> format_from(std::string_view name) {
  const auto* it =
      std::find_if(format_table.begin(), format_table.end(), [&](const auto& f) { return f.name == name; });
  if (it == format_table.end()) return std::nullopt;
  return it->format;
}

std::size_t bytes_per_texel(Format format) { return info(format).bytes; }
bool is_depth(Format format) { return info(format).depth; }
bool is_integer(Format format) { return info(format).integer; }

std::string_view to_string(TextureKind kind) {
  constexpr std::array<std::string_view, 5> names = {"2d", "2d-array", "3d", "cube", "cube-array"};
  return names.at(static_cast<std::size_t>(kind));
}

TextureDesc TextureDesc::with_channels(int channels) const {
  if (channels != 1) return *this;
  TextureDesc desc = *this;
  desc.grey = true;
  switch (format) {
    case Format::rgba8:
      desc.format = Format::r8;
      break;
    case Format::rgba16f:
      desc.format = Format::r16f;
      break;
    case Format::rgba32f:
      desc.format = Format::r32f;
      break;
    default:
      throw Error("a texture of format " + std::string(to_string(format)) + " holds no colour of one channel");
  }
  return desc;
}

std::size_t byte_size(const TextureDesc& desc) {
  std::size_t texels = 0;
  for (int mip = 0; mip < desc.mips; ++mip) {
    const auto side = [&](int n) { return static_cast<std::size_t>(std::max(n >> mip, 1)); };
    const bool volume = desc.kind == TextureKind::d3;
    texels += side(desc.width) * side(desc.height) * (volume ? side(desc.depth) : static_cast<std::size_t>(desc.depth));
  }
  return texels * bytes_per_texel(desc.format);
}

std::string to_string(const TextureDesc& desc) {
  std::string text(to_string(desc.format));
  text += ' ' + std::to_string(desc.width) + 'x' + std::to_string(desc.height);
  if (desc.kind == TextureKind::d3)
    text += 'x' + std::to_string(desc.depth);
  else if (desc.kind != TextureKind::d2)
    text += " x" + std::to_string(desc.depth);
  if (desc.kind == TextureKind::cube || desc.kind == TextureKind::cube_array) text += " cube";
  if (desc.mips > 1) text += " mips " + std::to_string(desc.mips);
  return text;
}

std::string_view to_string(Access access) {
  constexpr std::array<std::string_view, 8> names = {"sampled", "image_read", "image_write",  "image_read_write",
                                                     "color",   "depth",      "storage_read", "storage_write"};
  return names.at(static_cast<std::size_t>(access));
}

bool writes(Access access) {
  return access != Access::sampled && access != Access::image_read && access != Access::storage_read;
}

}  // namespace loom
