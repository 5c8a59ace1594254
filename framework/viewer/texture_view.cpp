#include "viewer/texture_view.h"

#include <algorithm>
#include <cmath>

#include <glm/vector_relational.hpp>

#include "core/srgb.h"
#include "gpu/format.h"
#include "measure/colormap.h"

namespace loom::viewer {
namespace {

constexpr std::uint32_t magenta = 0xffff00ffu;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::uint32_t pack(const glm::vec3& colour) {
  std::uint32_t packed = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    packed |= static_cast<std::uint32_t>(std::lround((colour[c] > 0 ? std::min(colour[c], 1.F) : 0.F) * 255))
              << (8 * c);
  return packed;
}

}  // namespace

glm::vec3 shown_channels(const glm::vec4& v, Channels channels, int count) {
  switch (channels) {
    case Channels::red:
      return glm::vec3(v.r);
    case Channels::green:
      return glm::vec3(v.g);
    case Channels::blue:
      return glm::vec3(v.b);
    case Channels::alpha:
      return glm::vec3(v.a);
    case Channels::rgb:
      break;
  }
  return count == 1 ? glm::vec3(v.r) : count == 2 ? glm::vec3(v.r, v.g, 0) : glm::vec3(v);
}

glm::vec2 percentile_range(std::vector<float>& values, glm::vec2 percent) {
  if (values.empty()) return {0, 1};
  const auto at = [&](float p) {
    const double place = std::clamp<double>(p, 0, 100) / 100 * static_cast<double>(values.size() - 1);
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::lround(place));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  };
  const glm::vec2 range(at(percent.x), at(percent.y));
  return range.y > range.x ? range : glm::vec2(range.x, range.x + 1);
}

std::uint32_t colour_of(const glm::vec3& value, const TextureViewSettings& settings, glm::vec2 range) {
  const bool negative = settings.flag == Flag::negative && std::min({value.x, value.y, value.z}) < 0;
  if (settings.flag != Flag::none && (!finite(value) || negative)) return magenta;
  if (!finite(value)) return pack(glm::vec3(0));
  glm::vec3 colour = (value - range.x) * (std::exp2(settings.exposure) / (range.y - range.x));
  if (settings.false_colour) {
    colour = measure::magma(.2126F * colour.r + .7152F * colour.g + .0722F * colour.b);
  } else if (settings.encode) {
    for (int c = 0; c < 3; ++c) colour[c] = linear_to_srgb(std::clamp(colour[c], 0.F, 1.F));
  }
  return pack(colour);
}

TexelBox level_box(const TextureDesc& desc, int mip) {
  const auto shrink = [mip](int n) { return std::max(n >> mip, 1); };
  const int depth = desc.kind == TextureKind::d3 ? shrink(desc.depth) : desc.kind == TextureKind::cube ? 6 : desc.depth;
  return {.size = {shrink(desc.width), shrink(desc.height), depth}};
}

SliceShape slice_shape(const TextureDesc& desc, int mip, int axis) {
  const glm::ivec3 size = level_box(desc, mip).size;
  if (desc.kind != TextureKind::d3 || axis == 2) return {size.x, size.y, size.z};
  if (axis == 0) return {size.z, size.y, size.x};
  return {size.x, size.z, size.y};
}

TexelBox slice_box(const TextureDesc& desc, const TextureViewSettings& settings) {
  TexelBox box = level_box(desc, settings.mip);
  const int axis = desc.kind == TextureKind::d3 ? settings.axis : 2;
  box.lower[axis] = settings.slice;
  box.size[axis] = 1;
  return box;
}

glm::ivec3 place_of(const TextureDesc& desc, const TextureViewSettings& settings, int x, int y) {
  const int up = slice_shape(desc, settings.mip, settings.axis).height - 1 - y;
  if (desc.kind != TextureKind::d3 || settings.axis == 2) return {x, up, settings.slice};
  if (settings.axis == 0) return {settings.slice, up, x};
  return {x, settings.slice, up};
}

std::optional<glm::vec4> texel_at(const Texels& texels, const TextureViewSettings& settings, int x, int y) {
  const SliceShape shape = slice_shape(texels.desc, texels.mip, settings.axis);
  if (x < 0 || y < 0 || x >= shape.width || y >= shape.height || settings.mip != texels.mip) return std::nullopt;
  const TexelBox& box = texels.box;
  const glm::ivec3 p = place_of(texels.desc, settings, x, y) - box.lower;
  if (glm::any(glm::lessThan(p, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(p, box.size))) return std::nullopt;
  return texels
      .values[(static_cast<std::size_t>(p.z) * static_cast<std::size_t>(box.size.y) + static_cast<std::size_t>(p.y)) *
                  static_cast<std::size_t>(box.size.x) +
              static_cast<std::size_t>(p.x)];
}

TextureView make_view(const Texels& texels, const TextureViewSettings& settings) {
  const SliceShape shape = slice_shape(texels.desc, texels.mip, settings.axis);
  const int count = gpu::gl_format(texels.desc.format).channels;
  TextureView view{.width = shape.width, .height = shape.height, .rgba = {}};
  std::vector<glm::vec3> pixels;
  std::vector<float> values;  // what percentiles are of
  pixels.reserve(static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height));
  for (int y = 0; y < shape.height; ++y)
    for (int x = 0; x < shape.width; ++x) {
      const glm::vec4 texel = texel_at(texels, settings, x, y).value_or(glm::vec4(0));
      const glm::vec3 pixel = shown_channels(texel, settings.channels, count);
      pixels.push_back(pixel);
      if (!finite(pixel)) {
        ++view.not_finite;
      } else {
        if (std::min({pixel.x, pixel.y, pixel.z}) < 0) ++view.negative;
        if (settings.percentiles)
          for (int c = 0; c < 3; ++c) values.push_back(pixel[c]);
      }
    }
  if (settings.percentiles) view.range = percentile_range(values, *settings.percentiles);
  view.rgba.reserve(pixels.size());
  for (const glm::vec3& pixel : pixels) view.rgba.push_back(colour_of(pixel, settings, view.range));
  return view;
}

}  // namespace loom::viewer
