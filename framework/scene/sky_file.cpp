// Skies from files.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include <fmt/core.h>

#include "core/image_io.h"
#include "scene/sky.h"

namespace loom::scene {
namespace {

/// 16 bytes each on the GPU, and a third more for the smaller levels: .7 GB.
constexpr std::size_t max_pixels = std::size_t{1} << 25;
/// A side of a texture, what OpenGL 4.5 guarantees.
constexpr int max_side = 16384;

[[noreturn]] void fail(std::string code, std::string message, const SourceLocation& where, std::string hint) {
  throw BadInput(Diagnostic{Severity::error, std::move(code), std::move(message), where, std::move(hint)});
}

/// BadInput of what reads files names the file; the place in the run file is said here.
ImageLayers read_layers(const std::string& path, const SourceLocation& where) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".exr") return read_exr(path);
  if (extension == ".hdr") return read_hdr(path);
  fail("sky-format", "the sky's image " + path + " is neither .exr nor .hdr", where,
       "give an equirectangular OpenEXR or Radiance file");
}

}  // namespace

SkyImage read_sky(const std::string& path, double scale, const SourceLocation& where, Diagnostics& diagnostics) {
  const ImageLayers layers = read_layers(path, where);
  const auto pixels = static_cast<std::size_t>(layers.width) * static_cast<std::size_t>(layers.height);
  if (pixels > max_pixels || layers.width > max_side || layers.height > max_side) {
    fail("sky-size", fmt::format("the sky's image {} has {}x{} pixels", path, layers.width, layers.height), where,
         fmt::format("it may have {} pixels, {} a side", max_pixels, max_side));
  }
  const auto channel = [&](const char* name) {
    const auto found = layers.channels.find(name);
    return found == layers.channels.end() ? nullptr : &found->second;
  };
  const std::vector<float>* const grey = channel("Y");
  const std::array<const std::vector<float>*, 3> rgb{channel("R"), channel("G"), channel("B")};
  const bool coloured = std::all_of(rgb.begin(), rgb.end(), [](const auto* c) { return c != nullptr; });
  if (!coloured && grey == nullptr)
    fail("sky-channels", "the sky's image " + path + " has no channels R, G and B", where, "nor has it Y");

  SkyImage image{.width = layers.width, .height = layers.height};
  image.radiance.resize(pixels);
  std::size_t negative = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto value = static_cast<float>(static_cast<double>((coloured ? *rgb.at(c) : *grey)[i]) * scale);
      if (!std::isfinite(value)) {
        const auto width = static_cast<std::size_t>(layers.width);
        fail("sky-not-finite",
             fmt::format("the sky's image {} has a value that is no finite number, at {}, {} from the top left", path,
                         i % width, i / width),
             where, "repair the image");
      }
      if (value < 0) ++negative;
      image.radiance[i][static_cast<glm::length_t>(c)] = std::max(0.F, value);
    }
  }
  if (negative > 0) {
    diagnostics.warning("sky-negative",
                        fmt::format("{} values of the sky's image {} are negative and count as zero", negative, path),
                        where);
  }
  return image;
}

}  // namespace loom::scene
