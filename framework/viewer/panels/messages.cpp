// What went wrong, whole, with its place; a click copies it.
#include <imgui.h>

#include <string>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

void draw_list(Ui& ui, const Diagnostics& diagnostics, bool& any) {
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    any = true;
    const std::string text = to_string(diagnostic);
    const ImVec4 tone = diagnostic.severity == Severity::error     ? colour::error
                        : diagnostic.severity == Severity::warning ? colour::changed
                                                                   : colour::dim;
    ImGui::PushID(&diagnostic);
    ImGui::PushStyleColor(ImGuiCol_Text, tone);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("click to copy");
    if (ImGui::IsItemClicked())
      ui.later([&ui, text] {
        ImGui::SetClipboardText(text.c_str());
        ui.notice = "copied the message";
      });
    ImGui::PopID();
    ImGui::Spacing();
  }
}

}  // namespace

void draw_messages(Ui& ui) {
  bool any = false;
  draw_list(ui, ui.model.problem(), any);
  draw_list(ui, ui.model.live().warnings(), any);
  if (!any) ImGui::TextDisabled("nothing is wrong");
}

}  // namespace loom::viewer
