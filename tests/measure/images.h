#pragma once
// Small images made in the test, and the layer view of them.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include <glm/vec3.hpp>

#include "measure/layers.h"

namespace loom::test {

/// R G B of a function of the pixel.
inline ImageLayers make_image(int width, int height, const std::function<glm::vec3(int x, int y)>& color,
                              const std::string& prefix = {}) {
  ImageLayers image{.width = width, .height = height, .channels = {}, .attributes = {}};
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (const char* c : {"R", "G", "B"}) image.channels[prefix + c].resize(pixels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec3 value = color(x, y);
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      image.channels[prefix + "R"][i] = value.r;
      image.channels[prefix + "G"][i] = value.g;
      image.channels[prefix + "B"][i] = value.b;
    }
  }
  return image;
}

inline ImageLayers uniform(int width, int height, glm::vec3 color) {
  return make_image(width, height, [color](int, int) { return color; });
}

inline measure::ImageFile exr(ImageLayers image, const std::string& path = "image.exr") {
  return {.path = path, .image = std::move(image), .hdr = true};
}

/// A view of the bare R G B; `image` must outlive it.
inline measure::Layer view(const ImageLayers& image) {
  measure::Layer layer{
      .width = image.width, .height = image.height, .name = "RGB", .channels = {"R", "G", "B"}, .planes = {}};
  for (const std::string& channel : layer.channels) layer.planes.emplace_back(image.channels.at(channel));
  return layer;
}

/// A repeatable value in [0,1) that looks random (PCG's output function on a counter).
inline float noise(int x, int y, int channel) {
  auto state = static_cast<std::uint32_t>(x + 977 * y + 1000003 * channel) * 747796405u + 2891336453u;
  state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return static_cast<float>((state >> 22u ^ state) >> 8u) / 16777216.f;
}

}  // namespace loom::test
