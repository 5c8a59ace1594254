// The picture, and the gestures that move the camera.
#include <imgui.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "viewer/camera_control.h"
#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

constexpr double radians_per_height = 3;  ///< a drag over the whole view
constexpr double zoom_per_notch = .9;
constexpr double seconds_across = 3;  ///< to fly through the scene's diagonal

/// Drags and the wheel over the picture; nothing where the camera stays.
std::optional<scene::Camera> dragged(const Model& model, float height) {
  scene::Camera camera = model.camera();
  if (!model.camera_moved()) aim_at_scene(camera, model.box());
  const ImGuiIO& io = ImGui::GetIO();
  const glm::dvec2 share = glm::dvec2(io.MouseDelta.x, -io.MouseDelta.y) / std::max<double>(height, 1);
  bool moved = false;
  if (ImGui::IsItemActive() && share != glm::dvec2(0)) {
    moved = true;
    if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
      look(camera, radians_per_height * .5 * share);
    } else if (ImGui::IsMouseDown(ImGuiMouseButton_Middle) || io.KeyShift) {
      pan(camera, -share);
    } else {
      orbit(camera, radians_per_height * -share);
    }
  }
  if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
    moved = true;
    zoom(camera, std::pow(zoom_per_notch, io.MouseWheel));
  }
  return moved ? std::optional(camera) : std::nullopt;
}

/// W A S D Q E while the right button is held.
std::optional<scene::Camera> flown(const Model& model, scene::Camera camera) {
  if (!ImGui::IsItemActive() || !ImGui::IsMouseDown(ImGuiMouseButton_Right)) return std::nullopt;
  const auto key = [](char c) { return ImGui::IsKeyDown(c) ? 1. : 0.; };
  glm::dvec3 way(key('D') - key('A'), key('E') - key('Q'), key('W') - key('S'));
  if (way == glm::dvec3(0)) return std::nullopt;
  const double speed = model.box().diagonal() / seconds_across * (ImGui::GetIO().KeyShift ? 4 : 1);
  fly(camera, way * speed * static_cast<double>(std::min(ImGui::GetIO().DeltaTime, .1F)));
  return camera;
}

/// The other pipeline right of the wipe, with both names and a handle to drag.
void draw_compared(Ui& ui, ImVec2 at, ImVec2 size) {
  const LivePipeline* other = ui.model.compared();
  const Texture* image = other == nullptr ? nullptr : other->renderer().output("image");
  if (image == nullptr) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float x = at.x + ui.wipe * size.x;
  list->AddImage(image_of(*image), {x, at.y}, {at.x + size.x, at.y + size.y}, {ui.wipe, 1}, {1, 0});
  const float grab = .5F * ImGui::GetFontSize();
  ImGui::SetCursorScreenPos({x - grab, at.y});
  ImGui::InvisibleButton("wipe", {2 * grab, size.y});
  if (ImGui::IsItemActive()) ui.wipe = std::clamp((ImGui::GetIO().MousePos.x - at.x) / size.x, 0.F, 1.F);
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  list->AddLine({x, at.y}, {x, at.y + size.y}, ImGui::ColorConvertFloat4ToU32(colour::changed), 2);
  const std::string& left = ui.model.live().graph().name;
  const std::string& right = other->graph().name;
  const ImU32 tone = IM_COL32(255, 255, 255, 230);
  list->AddText({x - ImGui::CalcTextSize(left.c_str()).x - grab, at.y + grab}, tone, left.c_str());
  list->AddText({x + grab, at.y + grab}, tone, right.c_str());
}

/// The inspected volume over the picture, and what the pointer rests on.
void draw_volume(Ui& ui, bool hovered) {
  const Texture* bodies = ui.overlay.picture();
  if (bodies == nullptr) return;
  const ImVec2 at(ui.picture_at.x, ui.picture_at.y), end(at.x + ui.picture_size.x, at.y + ui.picture_size.y);
  ImGui::GetWindowDrawList()->AddImage(image_of(*bodies), at, end, {0, 1}, {1, 0});
  if (!hovered) return;
  const glm::vec2 mouse(ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y);
  const glm::vec2 share = (mouse - ui.picture_at) / ui.picture_size;
  if (const std::string text = ui.overlay.text_at(ui.model, {share.x, 1 - share.y}); !text.empty())
    ImGui::SetTooltip("%s\n%s", ui.model.inspected().c_str(), text.c_str());
}

}  // namespace

void draw_view(Ui& ui) {
  Model& model = ui.model;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  ui.view_size = {std::max(static_cast<int>(room.x), 1), std::max(static_cast<int>(room.y), 1)};
  if (room.x < 2 || room.y < 2) return;
  const glm::vec2 frame(model.size());
  const float fit = std::min(room.x / frame.x, room.y / frame.y);
  const ImVec2 size(std::max(fit * frame.x, 1.F), std::max(fit * frame.y, 1.F));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 at(corner.x + .5F * (room.x - size.x), corner.y + .5F * (room.y - size.y));
  ImGui::SetCursorScreenPos(at);
  ui.picture_at = {at.x, at.y};
  ui.picture_size = {size.x, size.y};
  ImGui::InvisibleButton(
      "view", size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  ImGui::SetItemAllowOverlap();  // the handles of the wipe and of the lights lie over it
  const bool over = ImGui::IsItemHovered() && !ImGui::IsItemActive();
  std::optional<scene::Camera> camera = dragged(model, size.y);
  if (const auto flying = flown(model, camera.value_or(model.camera()))) camera = flying;
  if (camera) ui.later([&model, moved = *camera] { model.set_camera(moved); });

  const Texture* image = model.live().running() ? model.live().renderer().output("image") : nullptr;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 end(at.x + size.x, at.y + size.y);
  if (image == nullptr) {
    list->AddRectFilled(at, end, IM_COL32(0, 0, 0, 255));
    return;
  }
  // Row 0 of a texture is the bottom one.
  list->AddImage(image_of(*image), at, end, {0, 1}, {1, 0});
  draw_compared(ui, at, size);
  draw_volume(ui, over);
  ui.light_handles.draw(ui);
}

}  // namespace loom::viewer
