#include "viewer/panels/lights.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <string>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

ImU32 tone_of(HandleKind kind) {
  switch (kind) {
    case HandleKind::axis_x:
      return IM_COL32(235, 90, 80, 255);
    case HandleKind::axis_y:
      return IM_COL32(110, 205, 95, 255);
    case HandleKind::axis_z:
      return IM_COL32(95, 140, 245, 255);
    case HandleKind::direction:
      return ImGui::ColorConvertFloat4ToU32(colour::changed);
    case HandleKind::centre:
      break;
  }
  return IM_COL32(255, 255, 255, 255);
}

const char* tip_of(HandleKind kind) {
  switch (kind) {
    case HandleKind::axis_x:
      return "drag along x";
    case HandleKind::axis_y:
      return "drag along y";
    case HandleKind::axis_z:
      return "drag along z";
    case HandleKind::direction:
      return "drag to turn";
    case HandleKind::centre:
      break;
  }
  return "drag in the plane of the picture";
}

}  // namespace

glm::vec2 LightHandles::place_of(std::size_t light, HandleKind kind) const {
  for (const Shown& shown : shown_)
    if (shown.light == light && shown.handle.kind == kind) return shown.handle.at;
  return {-1, -1};
}

void LightHandles::draw(Ui& ui) {
  shown_.clear();
  if (!on) {
    drag_.reset();
    return;
  }
  const ScreenView view{.camera = scene::make_camera(ui.model.camera(), ui.model.box(), ui.model.size()),
                        .corner = ui.picture_at,
                        .size = ui.picture_size};
  ImDrawList* list = ImGui::GetWindowDrawList();
  const glm::vec2 end = ui.picture_at + ui.picture_size;
  list->PushClipRect({ui.picture_at.x, ui.picture_at.y}, {end.x, end.y}, true);
  const std::size_t count = ui.model.setup().scene.lights.size();
  for (std::size_t i = 0; i < count; ++i) draw_light(ui, view, i);
  list->PopClipRect();
}

void LightHandles::draw_light(Ui& ui, const ScreenView& view, std::size_t index) {
  const scene::Light& light = ui.model.setup().scene.lights[index];
  const float grab = .45F * ImGui::GetFontSize();
  ImDrawList* list = ImGui::GetWindowDrawList();
  // The centre last: where handles meet it is the one that is wanted, and the last one submitted is on top.
  std::vector<Handle> handles = handles_of(view, light, ui.model.box());
  std::reverse(handles.begin(), handles.end());
  for (const Handle& handle : handles) {
    const bool centre = handle.kind == HandleKind::centre;
    if (!centre && index != selected_) continue;
    const ImVec2 at(handle.at.x, handle.at.y), from(handle.from.x, handle.from.y);
    if (!centre) {
      list->AddLine(from, at, tone_of(handle.kind), 2);
      list->AddCircleFilled(at, .6F * grab, tone_of(handle.kind));
    } else {
      const float peak = std::max({light.intensity.x, light.intensity.y, light.intensity.z, 1e-6F});
      const glm::vec3 tint = light.intensity / peak;
      list->AddCircleFilled(at, grab, ImGui::ColorConvertFloat4ToU32({tint.x, tint.y, tint.z, 1}));
      list->AddCircle(at, grab, index == selected_ ? tone_of(HandleKind::direction) : IM_COL32(20, 20, 20, 255), 0, 2);
    }
    draw_handle(ui, view, index, handle);
  }
}

void LightHandles::draw_handle(Ui& ui, const ScreenView& view, std::size_t index, const Handle& handle) {
  shown_.push_back({index, handle});
  const float grab = .55F * ImGui::GetFontSize();
  ImGui::SetCursorScreenPos({handle.at.x - grab, handle.at.y - grab});
  ImGui::InvisibleButton(fmt::format("light {} {}", index, static_cast<int>(handle.kind)).c_str(),
                         {2 * grab, 2 * grab});
  ImGui::SetItemAllowOverlap();
  const glm::vec2 mouse(ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y);
  Model& model = ui.model;
  const scene::Light& light = model.setup().scene.lights[index];
  if (ImGui::IsItemActivated()) {
    selected_ = index;
    drag_ = Drag{index, handle.kind, mouse, light};
  }
  const bool ours = drag_ && drag_->light == index && drag_->kind == handle.kind;
  if (ours && ImGui::IsItemActive() && (ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0)) {
    if (const auto moved = dragged_light(view, drag_->before, model.box(), handle.kind, drag_->from, mouse))
      ui.later([&model, index, to = *moved] { model.set_light(index, to, fmt::format("light {}", index)); });
  }
  if (ImGui::IsItemDeactivated()) {
    drag_.reset();
    ui.later([&model] { model.end_gesture(); });
  }
  if (ImGui::IsItemHovered() && !ImGui::IsItemActive())
    ImGui::SetTooltip("%s\n%s", light.name.empty() ? fmt::format("light {}", index).c_str() : light.name.c_str(),
                      tip_of(handle.kind));
}

}  // namespace loom::viewer
