#pragma once
// The inspector of textures and buffers: any member of any bundle, and what outlives a frame.
#include <cstdint>
#include <memory>
#include <string>

#include <glm/vec2.hpp>

#include "loom/gpu.h"
#include "viewer/model.h"
#include "viewer/panels/buffer.h"
#include "viewer/texture_view.h"
#include "viewer/volume_cells.h"

namespace loom::viewer {

struct Ui;

class TexturePanel {
 public:
  void draw(Ui& ui);
  /// What is shown, for tests.
  [[nodiscard]] const TextureView& view() const { return view_; }
  /// How often texels were read back.
  [[nodiscard]] std::uint64_t reads() const { return reads_; }
  /// The line below the picture, and where the picture lies: its upper left corner on the screen, pixels a texel.
  [[nodiscard]] const std::string& said() const { return said_; }
  [[nodiscard]] glm::vec2 picture_at() const { return picture_at_; }
  [[nodiscard]] float texel_size() const { return texel_size_; }
  /// True where what is shown is older than what was rendered: a reading was put off, and is due now.
  [[nodiscard]] bool wants_redraw() const;
  /// The rows that are shown where it is a buffer.
  [[nodiscard]] const BufferTable& table() const { return table_; }
  TextureViewSettings settings;
  VolumeSettings volume;

 private:
  void draw_list(Ui& ui);
  void draw_controls(Ui& ui, const Texture& texture);
  void draw_range(const TextureDesc& desc);
  void draw_volume(Ui& ui);
  void draw_image();
  /// Another texture is looked at.
  void begin(const Inspectable& item);
  /// Reads the slice that is looked at where its pass made it anew, and makes the picture where anything changed.
  /// Reading takes at most a tenth of the time: what changes faster is shown later.
  void refresh(Ui& ui, const Texture& texture);

  BufferTable table_;
  Inspectable item_;  ///< what is looked at
  Texels texels_;
  TextureView view_;
  std::unique_ptr<Texture> picture_;
  std::string shown_;
  std::uint64_t version_ = ~std::uint64_t{0}, reads_ = 0;
  TextureViewSettings viewed_;
  double next_read_s_ = 0;
  bool put_off_ = false, stale_ = true;
  glm::vec2 percent_{1, 99};
  std::string filter_, said_;
  glm::vec2 picture_at_{0};
  float texel_size_ = 1;
};

}  // namespace loom::viewer
