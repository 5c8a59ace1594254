#pragma once
// The texture inspector: any member of any bundle, and what outlives a frame.
#include <cstdint>
#include <memory>
#include <string>

#include <glm/vec2.hpp>

#include "loom/gpu.h"
#include "viewer/texture_view.h"

namespace loom::viewer {

struct Ui;

class TexturePanel {
 public:
  void draw(Ui& ui);
  /// What is shown, for tests.
  [[nodiscard]] const TextureView& view() const { return view_; }
  TextureViewSettings settings;

 private:
  void draw_list(Ui& ui);
  void draw_controls(Ui& ui, const Texture& texture);
  void draw_image();
  /// Reads the texture where a frame was rendered since, and makes the picture where anything changed.
  void refresh(Ui& ui, const Texture& texture);

  Texels texels_;
  TextureView view_;
  std::unique_ptr<Texture> picture_;
  std::string shown_;
  std::uint64_t frame_ = ~std::uint64_t{0};
  bool stale_ = true;
  bool percentile_ = false;
  glm::vec2 percent_{1, 99};
  std::string filter_, unit_;
};

}  // namespace loom::viewer
