#include "viewer/buffer_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>

#include "interop/light.h"
#include "interop/vpl.h"

namespace loom::viewer {
namespace {

constexpr std::size_t word_bytes = 4;

/// Vpl of shaders/interop/vpl.h, after VplHeader.
BufferLayout virtual_lights() {
  static_assert(sizeof(interop::Vpl) == 12 * word_bytes);
  return {.header_words = sizeof(interop::VplHeader) / word_bytes,
          .counted = true,
          .columns = {{"position, m", 3}, {"order"}, {"normal", 3}, {"path"}, {"flux, W", 3}, {"kept"}},
          .known = true};
}

/// LightFace of shaders/interop/light.h.
BufferLayout light_faces() {
  static_assert(sizeof(interop::LightFace) == 32 * word_bytes);
  return {.columns = {{"view and projection, by column", 16},
                      {"origin, m", 3},
                      {"light"},
                      {"right", 3},
                      {"near or range, m"},
                      {"up", 3},
                      {"", 1},
                      {"forward", 3},
                      {"kind"}},
          .known = true};
}

}  // namespace

std::size_t BufferLayout::row_words() const {
  return std::accumulate(columns.begin(), columns.end(), std::size_t{0}, [](std::size_t sum, const BufferColumn& c) {
    return sum + static_cast<std::size_t>(c.words);
  });
}

BufferLayout layout_of(std::string_view bundle, std::string_view member, bool integers) {
  if (bundle == "VplSet" && member == "lights") return virtual_lights();
  if (bundle == "LightLayers" && member == "faces") return light_faces();
  if (bundle == "VplShadows" && member == "of")
    return {.columns = {{"1 + layer, 0: none", 1, WordKind::integer}}, .known = true};
  const WordKind kind = integers ? WordKind::integer : WordKind::real;
  return {.columns = {{"+0", 1, kind}, {"+4", 1, kind}, {"+8", 1, kind}, {"+12", 1, kind}}};
}

BufferPage read_page(const Buffer& buffer, const BufferLayout& layout, std::size_t first, std::size_t count) {
  BufferPage page{.layout = layout};
  const std::size_t row = layout.row_words(), words = buffer.bytes() / word_bytes;
  if (words < layout.header_words) return page;
  page.rows = (words - layout.header_words) / row;  // what is left over is no row
  if (layout.counted) {
    std::uint32_t used = 0;
    buffer.read(std::as_writable_bytes(std::span(&used, 1)));
    page.rows = std::min<std::size_t>(page.rows, used);
  }
  page.first = std::min(first, page.rows);
  page.words.resize(std::min(count, page.rows - page.first) * row);
  if (page.words.empty()) return page;
  buffer.read(std::as_writable_bytes(std::span(page.words)), (layout.header_words + page.first * row) * word_bytes);
  for (std::size_t r = 0; r < page.count(); ++r)
    for (std::size_t c = 0; c < layout.columns.size(); ++c) page.not_finite += cell_of(page, r, c).finite ? 0 : 1;
  return page;
}

BufferCell cell_of(const BufferPage& page, std::size_t row, std::size_t column) {
  std::size_t at = row * page.layout.row_words();
  for (std::size_t c = 0; c < column; ++c) at += static_cast<std::size_t>(page.layout.columns[c].words);
  const BufferColumn& shown = page.layout.columns[column];
  BufferCell cell;
  for (int i = 0; i < shown.words; ++i) {
    const std::uint32_t word = page.words[at + static_cast<std::size_t>(i)];
    if (i > 0) cell.text += "  ";
    if (shown.kind == WordKind::integer) {
      cell.text += fmt::format("{}", std::bit_cast<std::int32_t>(word));
    } else {
      const auto value = std::bit_cast<float>(word);
      cell.text += fmt::format("{:.5g}", value);
      cell.finite = cell.finite && std::isfinite(value);
    }
  }
  return cell;
}

}  // namespace loom::viewer
