#include "cli/output_image.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "cli/session.h"
#include "core/image_io.h"
#include "core/srgb.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;

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

OutputPath::OutputPath(std::string text) {
  const fs::path path(text);
  png_ = path.extension() == ".png";
  if (!png_ && path.extension() != ".exr") {
    throw bad_usage("-o " + text + ": a picture is a .png or an .exr", "for example -o out.png");
  }
  std::error_code ignored;
  const fs::path folder = path.parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    throw bad_usage("-o " + text + ": the folder " + folder.string() + " does not exist", "make it first");
  }
  if (fs::is_directory(path, ignored)) throw bad_usage("-o " + text + ": is a folder", "name a file");
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) {
    before_ = std::move(text);
    return;
  }
  const char* first = text.data() + percent + 1;
  const char* end = text.data() + text.size();
  width_ = 0;
  const auto digits = std::from_chars(first, end, width_);
  const bool plain = first != end && *first == 'd';
  const bool padded = first != end && *first == '0' && digits.ec == std::errc{} && digits.ptr != end &&
                      *digits.ptr == 'd' && width_ >= 1 && width_ <= 9;
  const char* letter = plain ? first : digits.ptr;
  if ((!plain && !padded) || std::find(letter, end, '%') != end) {
    throw bad_usage("-o " + text + ": a frame number is written %d or %04d, once", "for example -o out_%04d.png");
  }
  before_ = text.substr(0, percent);
  after_ = std::string(letter + 1, end);
}

std::string OutputPath::of_frame(int frame) const {
  if (!each_frame()) return before_;
  std::string number = std::to_string(frame);
  const auto digits = static_cast<std::size_t>(width_);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return before_ + number + after_;
}

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

}  // namespace loom::cli
