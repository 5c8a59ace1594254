#include "measure/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "core/image_io.h"
#include "core/srgb.h"

namespace loom::measure {
namespace {

/// Layers in rows, as square a sheet as they make.
graph::ReadImage sheet(const graph::ReadImage& image) {
  if (image.layers <= 1) return image;
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(image.layers))));
  const int rows = (image.layers + columns - 1) / columns;
  graph::ReadImage result{.width = columns * image.width, .height = rows * image.height, .layers = 1, .texels = {}};
  result.quantity = image.quantity;
  result.texels.assign(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height), glm::vec4(0));
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  for (std::size_t layer = 0; layer < static_cast<std::size_t>(image.layers); ++layer) {
    const std::size_t left = layer % static_cast<std::size_t>(columns) * width;
    const std::size_t top = layer / static_cast<std::size_t>(columns) * height;
    for (std::size_t y = 0; y < height; ++y) {
      const auto row = image.texels.begin() + static_cast<std::ptrdiff_t>((layer * height + y) * width);
      std::copy_n(row, width,
                  result.texels.begin() +
                      static_cast<std::ptrdiff_t>((top + y) * static_cast<std::size_t>(result.width) + left));
    }
  }
  return result;
}

float encoded(float linear) { return linear > 0.f ? std::min(linear_to_srgb(linear), 1.f) : 0.f; }

}  // namespace

void write_image(const std::string& path, bool png, const graph::ReadImage& image, const std::string& output) {
  const graph::ReadImage flat = sheet(image);
  if (png) {
    const bool display = flat.quantity == "display";
    std::vector<glm::vec3> pixels;
    pixels.reserve(flat.texels.size());
    for (const glm::vec4& texel : flat.texels) {
      pixels.emplace_back(display ? glm::vec3(texel) : glm::vec3(encoded(texel.r), encoded(texel.g), encoded(texel.b)));
    }
    write_png(path, flat.width, flat.height, pixels);
    return;
  }
  ImageLayers layers{.width = flat.width, .height = flat.height, .channels = {}, .attributes = {}};
  const std::array<const char*, 3> names = {"R", "G", "B"};
  for (std::size_t c = 0; c < names.size(); ++c) {
    std::vector<float>& channel = layers.channels[names[c]];
    channel.reserve(flat.texels.size());
    for (const glm::vec4& texel : flat.texels) channel.push_back(texel[static_cast<int>(c)]);
  }
  if (!flat.quantity.empty()) layers.attributes["loom:quantity"] = flat.quantity;
  layers.attributes["loom:output"] = output;
  write_exr(path, layers);
}

}  // namespace loom::measure
