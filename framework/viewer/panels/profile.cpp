#include "viewer/panels/profile.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "viewer/renderdoc.h"
#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

/// Hues that neighbours in a stack can be told apart by.
ImU32 hue(std::size_t index) {
  ImVec4 c{0, 0, 0, 1};
  const float golden = .618034F * static_cast<float>(index);
  ImGui::ColorConvertHSVtoRGB(golden - static_cast<float>(static_cast<int>(golden)), .55F, .85F, c.x, c.y, c.z);
  return ImGui::ColorConvertFloat4ToU32(c);
}

/// One column a frame, newest at the right, passes stacked in their order.
void draw_history(const Profile& profile, ImVec2 room) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("history", room);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(corner, {corner.x + room.x, corner.y + room.y}, IM_COL32(22, 23, 27, 255));
  double top = 1e-3;
  for (const ProfiledFrame& frame : profile.frames()) top = std::max(top, frame.gpu_ms());
  const float column = std::max(room.x / static_cast<float>(Profile::capacity), 2.F);
  float x = corner.x + room.x;
  for (auto frame = profile.frames().rbegin(); frame != profile.frames().rend() && x > corner.x; ++frame) {
    x -= column;
    float y = corner.y + room.y;
    const bool over =
        ImGui::IsItemHovered() && ImGui::GetIO().MousePos.x >= x && ImGui::GetIO().MousePos.x < x + column;
    std::string text = over ? fmt::format("frame {}: {:.2f} ms", frame->index, frame->gpu_ms()) : std::string();
    for (std::size_t i = 0; i < frame->passes.size(); ++i) {
      const auto height = static_cast<float>(frame->passes[i].gpu_ms / top) * room.y;
      list->AddRectFilled({x, y - height}, {x + column, y}, hue(i));
      y -= height;
      if (over) text += fmt::format("\n  {}: {:.2f} ms", frame->passes[i].name, frame->passes[i].gpu_ms);
    }
    if (over) ImGui::SetTooltip("%s", text.c_str());
  }
  list->AddText({corner.x + 4, corner.y + 2}, ImGui::GetColorU32(ImGuiCol_TextDisabled),
                fmt::format("{:.2f} ms", top).c_str());
}

void draw_table(const std::vector<graph::PassTimes>& times) {
  if (!ImGui::BeginTable("passes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) return;
  for (const char* name : {"pass", "GPU ms", "p95", "CPU ms"}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  for (std::size_t i = 0; i < times.size(); ++i) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(hue(i)), "■");
    ImGui::SameLine();
    ImGui::TextUnformatted(times[i].name.c_str());
    for (const double value : {times[i].gpu_median_ms, times[i].gpu_p95_ms, times[i].cpu_median_ms}) {
      ImGui::TableNextColumn();
      ImGui::Text("%.3f", value);
    }
  }
  ImGui::EndTable();
}

}  // namespace

void capture_frame(Ui& ui) {
  ui.later([&ui] {
    const std::string path = renderdoc_capture([&ui] { ui.model.render_all(); });
    ui.notice = path.empty() ? "RenderDoc gave no capture" : "captured " + path;
  });
}

void ProfilePanel::draw(Ui& ui) {
  const Profile& profile = ui.model.profile();
  if (ImGui::Button("Export trace"))
    ui.later([&ui] {
      const std::string text = ui.model.profile().chrome_trace();
      write_file_atomic("trace.json", std::as_bytes(std::span(text)));
      ui.notice = "saved " + std::filesystem::absolute("trace.json").string() + " for chrome://tracing or Perfetto";
    });
  ImGui::SameLine();
  const bool attached = renderdoc_attached();
  ImGui::BeginDisabled(!attached);
  if (ImGui::Button("Capture")) capture_frame(ui);
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    ImGui::SetTooltip(attached ? "one frame, all passes, with RenderDoc (F11)"
                               : "RenderDoc is not attached: start `loom view` from it");
  ImGui::SameLine();
  const graph::FrameTimes& times = ui.model.frame_times();
  ImGui::TextDisabled("frame: %.2f ms GPU, %.2f ms CPU, %.2f ms wall (medians)", times.gpu_median_ms,
                      times.cpu_median_ms, times.wall_median_ms);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.y < 30) return;
  draw_history(profile, {room.x, std::max(.35F * room.y, 20.F)});
  if (ImGui::BeginChild("table")) draw_table(ui.model.pass_times());
  ImGui::EndChild();
}

}  // namespace loom::viewer
