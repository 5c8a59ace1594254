#pragma once
// A buffer of a bundle as a table, a page of rows at a time.
#include <cstddef>
#include <cstdint>
#include <string>

#include "loom/gpu.h"
#include "viewer/buffer_view.h"
#include "viewer/model.h"

namespace loom::viewer {

struct Ui;

class BufferTable {
 public:
  /// `item`: what the buffer is.
  void draw(Ui& ui, const Inspectable& item, const Buffer& buffer);
  /// What is shown, for tests.
  [[nodiscard]] const BufferPage& page() const { return page_; }

 private:
  void draw_rows() const;

  BufferPage page_;
  std::string shown_;
  std::uint64_t version_ = ~std::uint64_t{0};
  int number_ = 0;  ///< of the page, from 0
  bool integers_ = false;
};

}  // namespace loom::viewer
