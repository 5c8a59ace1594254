#pragma once
// A storage buffer as a table: rows of named columns where the struct is known (shaders/interop), else rows of four
// words.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "loom/gpu.h"

namespace loom::viewer {

enum class WordKind : std::uint8_t { real, integer };

struct BufferColumn {
  std::string name;  ///< with its unit
  int words = 1;     ///< of four bytes, in a row
  WordKind kind = WordKind::real;
};

struct BufferLayout {
  std::size_t header_words = 0;  ///< before the first row
  bool counted = false;          ///< the first word of the header says how many rows are in use
  std::vector<BufferColumn> columns;
  bool known = false;  ///< false: four words a row, of which nobody says what they are

  [[nodiscard]] std::size_t row_words() const;
};

/// Of a member of a built-in bundle; others are taken as four numbers a row, `integers`: as whole ones.
BufferLayout layout_of(std::string_view bundle, std::string_view member, bool integers = false);

/// Some rows, read back.
struct BufferPage {
  BufferLayout layout;
  std::size_t rows = 0;   ///< in use, in the whole buffer
  std::size_t first = 0;  ///< of these
  std::vector<std::uint32_t> words;
  std::size_t not_finite = 0;  ///< numbers on this page

  [[nodiscard]] std::size_t count() const { return words.size() / layout.row_words(); }
};

/// At most `count` rows from `first` on; as many as there are. Waits for the device.
BufferPage read_page(const Buffer& buffer, const BufferLayout& layout, std::size_t first, std::size_t count);

struct BufferCell {
  std::string text;
  bool finite = true;
};
/// `row`: on the page.
BufferCell cell_of(const BufferPage& page, std::size_t row, std::size_t column);

}  // namespace loom::viewer
