#include "viewer/panels/buffer.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

constexpr std::size_t page_rows = 256;

}  // namespace

void BufferTable::draw(Ui& ui, const Inspectable& item, const Buffer& buffer) {
  ImGui::TextColored(colour::accent, "%s", item.name.c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%zu bytes", buffer.bytes());
  if (!page_.layout.known) {
    ImGui::SameLine();
    ImGui::Checkbox("whole numbers", &integers_);
  }
  const std::string key = fmt::format("{} {} {} {}", item.name, buffer.name(), number_, integers_);
  if (key != shown_ || version_ != ui.model.inspected_version()) {
    page_ = read_page(buffer, layout_of(item.type, item.member, integers_),
                      static_cast<std::size_t>(number_) * page_rows, page_rows);
    shown_ = key;
    version_ = ui.model.inspected_version();
  }
  const int pages = std::max(1, static_cast<int>((page_.rows + page_rows - 1) / page_rows));
  number_ = std::clamp(number_, 0, pages - 1);
  ImGui::SameLine();
  ImGui::TextDisabled("%zu rows", page_.rows);
  if (pages > 1) {
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 7);
    ImGui::SliderInt("page", &number_, 0, pages - 1, "%d", ImGuiSliderFlags_AlwaysClamp);
  }
  if (page_.not_finite > 0) {
    ImGui::SameLine();
    ImGui::TextColored(colour::error, "%zu not finite", page_.not_finite);
  }
  draw_rows();
}

void BufferTable::draw_rows() const {
  const auto columns = static_cast<int>(page_.layout.columns.size());
  constexpr ImGuiTableFlags flags = ImGuiTableFlags_ScrollX | ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg |
                                    ImGuiTableFlags_BordersInnerV | ImGuiTableFlags_SizingFixedFit |
                                    ImGuiTableFlags_Resizable;
  if (columns == 0 || !ImGui::BeginTable("rows", columns + 1, flags)) return;
  ImGui::TableSetupScrollFreeze(1, 1);
  ImGui::TableSetupColumn("row");
  for (const BufferColumn& column : page_.layout.columns) ImGui::TableSetupColumn(column.name.c_str());
  ImGui::TableHeadersRow();
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(page_.count()));
  while (clipper.Step()) {
    for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%zu", page_.first + static_cast<std::size_t>(row));
      for (int column = 0; column < columns; ++column) {
        ImGui::TableNextColumn();
        const BufferCell cell = cell_of(page_, static_cast<std::size_t>(row), static_cast<std::size_t>(column));
        if (cell.finite) {
          ImGui::TextUnformatted(cell.text.c_str());
        } else {
          ImGui::TextColored(colour::flagged, "%s", cell.text.c_str());
        }
      }
    }
  }
  ImGui::EndTable();
}

}  // namespace loom::viewer
