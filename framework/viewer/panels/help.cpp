// Keys and gestures.
#include <imgui.h>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

struct Line {
  const char* keys;
  const char* what;
};

constexpr Line lines[] = {
    {"left drag", "orbit"},
    {"right drag, W A S D Q E", "look around and fly; Shift is faster"},
    {"middle drag, Shift + left drag", "pan"},
    {"wheel", "nearer and farther"},
    {"Home", "the scene's own camera"},
    {"Ctrl + Z, Ctrl + Y", "undo, redo"},
    {"Ctrl + click on a slider", "type a value"},
    {"Ctrl + S", "save as pipeline"},
    {"Ctrl + Shift + C", "copy a command line that renders this view"},
    {"F12, Shift + F12", "picture as PNG, radiance as EXR"},
    {"F11", "capture a frame, where RenderDoc is attached"},
    {"Space, .", "play or pause, one step"},
    {"L", "handles of the lights: drag to move and turn them"},
    {"R", "forget history and accumulated state"},
    {"1 2 3 4 5", "graph, texture, profile, reference, messages"},
    {"drop a file", "open a .gltf, .glb, run file, pipeline or report"},
    {"?", "this page"},
};

}  // namespace

void draw_help(Ui& ui) {
  if (!ui.show_help) return;
  const ImVec2 centre = ImGui::GetMainViewport()->GetCenter();
  ImGui::SetNextWindowPos(centre, ImGuiCond_Appearing, {.5F, .5F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  if (ImGui::Begin("Keys and gestures", &ui.show_help,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
      for (const Line& line : lines) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextColored(colour::accent, "%s", line.keys);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(line.what);
      }
      ImGui::EndTable();
    }
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace loom::viewer
