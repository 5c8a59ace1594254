#include "viewer/texture_view.h"

#include <algorithm>
#include <cmath>

#include "core/srgb.h"
#include "gpu/format.h"
#include "measure/colormap.h"

namespace loom::viewer {
namespace {

constexpr std::uint32_t magenta = 0xffff00ffu;

struct Level {
  int width, height, depth;
};

Level level_of(const TextureDesc& desc, int mip) {
  const int depth = desc.kind == TextureKind::d3 ? std::max(desc.depth >> mip, 1) : desc.depth;
  return {std::max(desc.width >> mip, 1), std::max(desc.height >> mip, 1), depth};
}

/// Where in the level pixel (x, y) of the slice lies, row 0 at the top. A volume seen along x shows z to the right and
/// y upwards; along y, x to the right and z upwards.
glm::ivec3 position(const TextureDesc& desc, const TextureViewSettings& s, const SliceShape& shape, int x, int y) {
  const int up = shape.height - 1 - y;
  if (desc.kind != TextureKind::d3 || s.axis == 2) return {x, up, s.slice};
  if (s.axis == 0) return {s.slice, up, x};
  return {x, s.slice, up};
}

const glm::vec4& value_at(const Texels& texels, const Level& level, const glm::ivec3& p) {
  return texels
      .values[(static_cast<std::size_t>(p.z) * static_cast<std::size_t>(level.height) + static_cast<std::size_t>(p.y)) *
                  static_cast<std::size_t>(level.width) +
              static_cast<std::size_t>(p.x)];
}

/// The channels that the view shows; a single one stands three times.
glm::vec3 shown(const glm::vec4& v, Channels channels, int count) {
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

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::uint32_t pack(const glm::vec3& colour) {
  std::uint32_t packed = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    packed |= static_cast<std::uint32_t>(std::clamp(colour[c], 0.F, 1.F) * 255 + .5F) << (8 * c);
  return packed;
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

}  // namespace

SliceShape slice_shape(const TextureDesc& desc, int mip, int axis) {
  const Level level = level_of(desc, mip);
  if (desc.kind != TextureKind::d3 || axis == 2) return {level.width, level.height, level.depth};
  if (axis == 0) return {level.depth, level.height, level.width};
  return {level.width, level.depth, level.height};
}

std::optional<glm::vec4> texel_at(const Texels& texels, const TextureViewSettings& settings, int x, int y) {
  const SliceShape shape = slice_shape(texels.desc, texels.mip, settings.axis);
  if (x < 0 || y < 0 || x >= shape.width || y >= shape.height || settings.slice < 0 || settings.slice >= shape.count)
    return std::nullopt;
  return value_at(texels, level_of(texels.desc, texels.mip), position(texels.desc, settings, shape, x, y));
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
      const glm::vec3 pixel = shown(texel_at(texels, settings, x, y).value_or(glm::vec4(0)), settings.channels, count);
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
  const float gain = std::exp2(settings.exposure) / (view.range.y - view.range.x);
  view.rgba.reserve(pixels.size());
  for (const glm::vec3& pixel : pixels) {
    const bool bad = !finite(pixel) || std::min({pixel.x, pixel.y, pixel.z}) < 0;
    if (bad && settings.flag) {
      view.rgba.push_back(magenta);
      continue;
    }
    glm::vec3 colour = (pixel - view.range.x) * gain;
    if (settings.false_colour) {
      colour = measure::magma(.2126F * colour.r + .7152F * colour.g + .0722F * colour.b);
    } else if (settings.encode) {
      for (int c = 0; c < 3; ++c) colour[c] = linear_to_srgb(std::clamp(colour[c], 0.F, 1.F));
    }
    view.rgba.push_back(pack(colour));
  }
  return view;
}

}  // namespace loom::viewer
