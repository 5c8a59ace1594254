#pragma once
// From an output of the graph to a picture file.
#include <string>

#include "graph/run/renderer.h"

namespace loom::cli {

/// Where pictures go: a .png or .exr, one for all frames or, with one `%d` or `%0Nd` in it, one a frame.
class OutputPath {
 public:
  /// Throws BadInput where the ending is neither, the pattern is none, or the folder does not exist.
  explicit OutputPath(std::string text);
  [[nodiscard]] bool is_png() const { return png_; }
  [[nodiscard]] bool each_frame() const { return width_ >= 0; }
  [[nodiscard]] std::string of_frame(int frame) const;

 private:
  std::string before_, after_;
  int width_ = -1;  ///< digits of the frame number, −1: no number
  bool png_ = false;
};

/// Writes the picture. EXR: R, G, B in 32-bit float, attributes loom:quantity and loom:output (`output`, by which
/// compare tells bounce from indirect irradiance). PNG: display-referred values as they are; anything else clamped to
/// [0, 1] and sRGB-encoded. Layers and slices are laid side by side, in rows.
void write_image(const std::string& path, bool png, const graph::ReadImage& image, const std::string& output);

}  // namespace loom::cli
