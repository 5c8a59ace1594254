#include "viewer/panels/pareto.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "loom/diagnostic.h"
#include "viewer/theme.h"

namespace loom::viewer {
namespace {

/// A logarithmic axis around what it shall show.
class Axis {
 public:
  void add(double value) {
    low_ = std::min(low_, std::log10(std::max(value, 1e-9)));
    high_ = std::max(high_, std::log10(std::max(value, 1e-9)));
  }
  /// A single point stands in the middle of a factor of four.
  void widen() {
    const double more = std::max(.06 * (high_ - low_), .3);
    low_ -= more;
    high_ += more;
  }
  [[nodiscard]] float at(double value) const {
    return static_cast<float>((std::log10(std::max(value, 1e-9)) - low_) / (high_ - low_));
  }
  /// Powers of ten, or where there are none the middle.
  [[nodiscard]] std::vector<double> marks() const {
    std::vector<double> marks;
    for (double e = std::ceil(low_); e <= high_; ++e) marks.push_back(std::pow(10, e));
    if (marks.empty()) marks.push_back(std::pow(10, .5 * (low_ + high_)));
    return marks;
  }

 private:
  double low_ = std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::lowest();
};

struct Area {
  ImVec2 corner, size;
  Axis cost, error;
  [[nodiscard]] ImVec2 at(double ms, double relmse) const {
    return {corner.x + size.x * cost.at(ms), corner.y + size.y * (1 - error.at(relmse))};
  }
};

void draw_axes(const Area& area) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImU32 line = IM_COL32(44, 47, 54, 255), text = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  const ImVec2 end(area.corner.x + area.size.x, area.corner.y + area.size.y);
  float taken = area.corner.x;  // labels end where the next may begin
  for (const double ms : area.cost.marks()) {
    const float x = area.at(ms, 1).x;
    list->AddLine({x, area.corner.y}, {x, end.y}, line);
    const std::string label = fmt::format("{:g} ms", std::round(1e6 * ms) / 1e6);
    const float width = ImGui::CalcTextSize(label.c_str()).x, at = std::min(x + 3, end.x - width);
    if (at < taken) continue;
    list->AddText({at, end.y - ImGui::GetFontSize()}, text, label.c_str());
    taken = at + width + ImGui::GetFontSize();
  }
  for (const double error : area.error.marks()) {
    const float y = area.at(1, error).y;
    list->AddLine({area.corner.x, y}, {end.x, y}, line);
    list->AddText({area.corner.x + 3, std::max(y - ImGui::GetFontSize(), area.corner.y)}, text,
                  fmt::format("{:.3g}", error).c_str());
  }
}

}  // namespace

void ParetoPlot::load(const std::string& path, const std::string& open_scene) {
  const std::string file = report_file(path);
  report_ = load_report(file.empty() ? path : file);
  path_ = report_->file;
  failure_.clear();
  scene_ = report_->scenes.front();
  const std::string stem = open_scene.empty() ? "cornell-box" : std::filesystem::path(open_scene).stem().string();
  for (const std::string& scene : report_->scenes)
    if (std::filesystem::path(scene).stem() == stem) scene_ = scene;
}

void ParetoPlot::draw_controls(const std::string& open_scene, glm::ivec2 size) {
  ImGui::SetNextItemWidth(16 * ImGui::GetFontSize());
  bool entered =
      ImGui::InputTextWithHint("##report", "report.json of loom measure", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::SameLine();
  entered = ImGui::Button("Load report") || entered;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("its points stand in the plot; a report can be dropped, too");
  if (entered) {
    try {
      load(path_, open_scene);
    } catch (const Error& error) {
      failure_ = error.what();
    }
  }
  ImGui::SameLine();
  if (!failure_.empty()) {
    ImGui::TextColored(colour::error, "%s", failure_.substr(0, failure_.find('\n')).c_str());
    return;
  }
  if (!report_) {
    ImGui::NewLine();
    return;
  }
  ImGui::SetNextItemWidth(10 * ImGui::GetFontSize());
  if (ImGui::BeginCombo("##scene", scene_.c_str())) {
    for (const std::string& scene : report_->scenes)
      if (ImGui::Selectable(scene.c_str(), scene == scene_)) scene_ = scene;
    ImGui::EndCombo();
  }
  for (const ReportPoint& point : report_->points) {
    if (point.scene != scene_) continue;
    ImGui::SameLine();
    ImGui::TextDisabled("report: %d×%d, %d samples; here: %d×%d, 1", point.size.x, point.size.y, point.samples, size.x,
                        size.y);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("times are those of a frame: compare at one size and as many samples");
    break;
  }
}

void ParetoPlot::draw_plot(const std::vector<MeasuredPoint>& live, const std::string& open) const {
  const ImVec2 room(std::max(ImGui::GetContentRegionAvail().x, 40.F), std::max(ImGui::GetContentRegionAvail().y, 40.F));
  const float title = ImGui::GetTextLineHeightWithSpacing();
  Area area{.corner = ImGui::GetCursorScreenPos(), .size = room, .cost = {}, .error = {}};
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 end(area.corner.x + room.x, area.corner.y + room.y);
  ImGui::InvisibleButton("plot", room);
  const bool hovered = ImGui::IsItemHovered();
  list->AddRectFilled(area.corner, end, IM_COL32(22, 23, 27, 255));
  list->PushClipRect(area.corner, end, true);
  list->AddText({area.corner.x + 4, area.corner.y + 2}, ImGui::GetColorU32(ImGuiCol_TextDisabled),
                "relMSE over GPU ms: lower left is better");
  area.corner.y += title;
  area.size.y -= title;
  std::vector<const ReportPoint*> published;
  if (report_)
    for (const ReportPoint& point : report_->points)
      if (point.scene == scene_) published.push_back(&point);
  for (const MeasuredPoint& p : live) area.cost.add(p.gpu_ms), area.error.add(p.relmse);
  for (const ReportPoint* p : published) area.cost.add(p->gpu_ms), area.error.add(p->relmse);
  if (!live.empty() || !published.empty()) {
    area.cost.widen();
    area.error.widen();
    draw_axes(area);
  }
  const ReportPoint* nearest = nullptr;
  float reach = 8;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (const ReportPoint* p : published) {
    const ImVec2 at = area.at(p->gpu_ms, p->relmse);
    list->AddCircleFilled(at, p->front ? 4.F : 3.F,
                          ImGui::ColorConvertFloat4ToU32(p->front ? colour::good : ImVec4(.42F, .44F, .5F, 1)));
    const float away = std::hypot(at.x - mouse.x, at.y - mouse.y);
    if (hovered && away < reach) {
      reach = away;
      nearest = p;
    }
  }
  for (const MeasuredPoint& p : live) {
    const ImVec2 at = area.at(p.gpu_ms, p.relmse);
    const bool is_open = p.pipeline == open;
    list->AddCircleFilled(at, is_open ? 6.F : 4.F,
                          ImGui::ColorConvertFloat4ToU32(is_open ? colour::changed : colour::accent));
    const std::string text = fmt::format("{}  {:.3g} ms  {:.3g}", p.pipeline, p.gpu_ms, p.relmse);
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    const float x = at.x + 9 + width < end.x ? at.x + 9 : std::max(at.x - 9 - width, area.corner.x + 2);
    list->AddText({x, at.y - .5F * ImGui::GetFontSize()}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
  }
  list->PopClipRect();
  if (nearest != nullptr)
    ImGui::SetTooltip("%s\n%.4g ms, relMSE %.3g%s", nearest->label.c_str(), nearest->gpu_ms, nearest->relmse,
                      nearest->front ? "\nnothing measured is better in both" : "");
}

}  // namespace loom::viewer
