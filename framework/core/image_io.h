#pragma once
// PNG and EXR files. Writers write beside the target and rename, so that no half-written file is ever left.
#include <map>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/export.h"

namespace loom {

/// Channels of one size, row 0 at the top, 32-bit float. Keys are EXR channel names: "R", "direct.G", "depth.Z".
struct ImageLayers {
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;
  std::map<std::string, std::string>
      attributes;  ///< strings: `loom:quantity` (what it is), `loom:output` (of which output)
};

/// 8-bit sRGB PNG from display-referred RGB in [0,1] that is already sRGB-encoded (Tonemap's output).
LOOM_API void write_png(const std::string& path, int width, int height, std::span<const glm::vec3> display);
/// Single part, scanline, ZIP, 32-bit float.
LOOM_API void write_exr(const std::string& path, const ImageLayers& image);
/// Throws BadInput where the file is missing or damaged.
LOOM_API ImageLayers read_exr(const std::string& path);
/// "R" "G" "B" from a Radiance RGBE picture.
LOOM_API ImageLayers read_hdr(const std::string& path);
/// Linear Rec.709 "R" "G" "B" from an 8-bit sRGB PNG.
LOOM_API ImageLayers read_png(const std::string& path);
/// Writes `bytes` beside `path`, then renames. Throws Error.
LOOM_API void write_file_atomic(const std::string& path, std::span<const std::byte> bytes);

}  // namespace loom
