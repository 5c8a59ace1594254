// Camera, bookmarks, lights, time.
#include <fmt/core.h>
#include <imgui.h>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <string>

#include "viewer/ui.h"

namespace loom::viewer {
namespace {

void draw_camera(Ui& ui) {
  Model& model = ui.model;
  scene::Camera camera = model.camera();
  glm::vec3 eye(camera.eye), target(camera.target);
  auto degrees = static_cast<float>(glm::degrees(camera.yfov_rad));
  bool moved = ImGui::DragFloat3("eye", &eye.x, .01F, 0, 0, "%.3g");
  moved = ImGui::DragFloat3("target", &target.x, .01F, 0, 0, "%.3g") || moved;
  moved = ImGui::SliderFloat("field", &degrees, 1, 150, "%.3g°", ImGuiSliderFlags_AlwaysClamp) || moved;
  if (moved && glm::distance(eye, target) > 0) {
    camera.eye = eye;
    camera.target = target;
    camera.yfov_rad = glm::radians(static_cast<double>(degrees));
    ui.later([&model, camera] { model.set_camera(camera); });
  }
  if (ImGui::Button("Home")) ui.later([&model] { model.reset_camera(); });
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the scene's own camera (Home)");
  ImGui::SameLine();
  std::vector<Bookmark>& marks = ui.user.bookmarks[model.scene_path()];
  if (ImGui::Button("+ Bookmark"))
    marks.push_back({.name = fmt::format("view {}", marks.size() + 1), .camera = model.camera()});
  ui.note_place("bookmark");
  for (std::size_t i = 0; i < marks.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Button(marks[i].name.c_str())) ui.later([&model, mark = marks[i].camera] { model.set_camera(mark); });
    ImGui::SameLine();
    const bool gone = ImGui::SmallButton("×");
    ImGui::PopID();
    if (gone) {
      marks.erase(marks.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    }
  }
}

void draw_light(Ui& ui, std::size_t index, scene::Light light) {
  Model& model = ui.model;
  constexpr const char* kinds[] = {"point", "spot", "directional"};
  const std::string gesture = fmt::format("light {}", index);
  const float reach = static_cast<float>(std::max(model.box().diagonal(), 1e-3));
  if (!ImGui::TreeNodeEx(fmt::format("{} · {}###light", light.name.empty() ? gesture : light.name,
                                     kinds[static_cast<std::size_t>(light.kind)])
                             .c_str(),
                         ImGuiTreeNodeFlags_DefaultOpen))
    return;
  bool changed = false, ended = false;
  const auto after = [&](bool edited) {
    changed = edited || changed;
    ended = ImGui::IsItemDeactivated() || ended;
  };
  if (light.kind != scene::LightKind::directional) {
    glm::vec3 position(light.position);
    after(ImGui::DragFloat3("position, m", &position.x, .003F * reach, -10 * reach, 10 * reach, "%.3g"));
    light.position = position;
  }
  if (light.kind != scene::LightKind::point) {
    glm::vec3 direction(light.direction);
    after(ImGui::DragFloat3("direction", &direction.x, .01F, -1, 1, "%.2f"));
    if (glm::length(direction) > 1e-3F) light.direction = glm::normalize(glm::dvec3(direction));
  }
  // Intensity and chroma apart, so that both are easy to hold.
  float strength = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
  glm::vec3 tint = strength > 0 ? light.intensity / strength : glm::vec3(1);
  const char* unit = light.kind == scene::LightKind::directional ? "%.4g W/m²" : "%.4g W/sr";
  after(ImGui::DragFloat("intensity", &strength, .01F * std::max(strength, .1F), 0, 1e6F, unit,
                         ImGuiSliderFlags_AlwaysClamp));
  after(ImGui::ColorEdit3("colour", &tint.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs));
  light.intensity = strength * glm::max(tint, glm::vec3(0));
  ImGui::TreePop();
  if (changed) ui.later([&model, index, light, gesture] { model.set_light(index, light, gesture); });
  if (ended) ui.later([&model] { model.end_gesture(); });
}

}  // namespace

void draw_scene(Ui& ui) {
  Model& model = ui.model;
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(model.scene_path().empty() ? "built-in Cornell box" : model.scene_path().c_str());
  ImGui::PopTextWrapPos();
  ImGui::TextDisabled("%zu triangles, %d lights", model.facts().triangles, model.facts().lights());
  ImGui::TextDisabled("drop a file here to open it");
  ImGui::PushItemWidth(-ImGui::GetFontSize() * 6);
  if (ImGui::CollapsingHeader("Camera", ImGuiTreeNodeFlags_DefaultOpen)) draw_camera(ui);
  if (ImGui::CollapsingHeader("Lights", ImGuiTreeNodeFlags_DefaultOpen)) {
    const auto& lights = model.setup().scene.lights;
    if (lights.empty()) {
      ImGui::TextDisabled("no punctual lights");
    } else {
      ImGui::Checkbox("handles in the picture (L)", &ui.light_handles.on);
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      draw_light(ui, i, lights[i]);
      ImGui::PopID();
    }
  }
  if (model.animated() && ImGui::CollapsingHeader("Animation", ImGuiTreeNodeFlags_DefaultOpen)) {
    auto time = static_cast<float>(model.time());
    if (ImGui::DragFloat("time", &time, .01F, 0, 1e6F, "%.2f s", ImGuiSliderFlags_AlwaysClamp))
      ui.later([&model, time] { model.set_time(time); });
  }
  ImGui::PopItemWidth();
}

}  // namespace loom::viewer
