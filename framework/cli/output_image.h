#pragma once
// The value of -o.
#include <string>

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

}  // namespace loom::cli
