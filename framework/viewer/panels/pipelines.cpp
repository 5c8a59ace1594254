// The pipelines of the folder; a click switches.
#include <imgui.h>

#include <filesystem>
#include <string>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {

void draw_pipelines(Ui& ui) {
  Model& model = ui.model;
  const std::string& open = model.pipeline_path();
  for (const std::string& path : model.pipelines()) {
    const std::string name = std::filesystem::path(path).stem().string();
    const bool selected = path == open;
    if (ImGui::Selectable((name + "##" + path).c_str(), selected) && !selected)
      ui.later([&model, path] { model.open_pipeline(path); });
    ui.note_place(path);
    const bool compared = path == model.compared_path();
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right))
      ui.later([&model, path, compared] { model.compare_with(compared ? std::string() : path); });
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\nright click: %s", path.c_str(),
                        compared ? "no longer compare" : "compare with it by a wipe");
    if (compared) {
      ImGui::SameLine();
      ImGui::TextColored(colour::changed, "◧");
    }
  }
  ImGui::Separator();
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", model.live().graph().summary.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace loom::viewer
