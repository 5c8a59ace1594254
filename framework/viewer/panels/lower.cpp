// The tabs below the picture.
#include <imgui.h>

#include <functional>

#include "viewer/ui.h"

namespace loom::viewer {
namespace {

void tab(Ui& ui, Tab which, const char* name, const std::function<void()>& draw) {
  const bool chosen = ui.switch_tab && ui.tab == which;
  if (!ImGui::BeginTabItem(name, nullptr, chosen ? ImGuiTabItemFlags_SetSelected : 0)) return;
  if (!ui.switch_tab) ui.tab = which;
  draw();
  ImGui::EndTabItem();
}

}  // namespace

void draw_lower_tabs(Ui& ui) {
  if (!ImGui::BeginTabBar("lower tabs")) return;
  tab(ui, Tab::graph, "Graph", [&] { ui.graph_panel.draw(ui); });
  tab(ui, Tab::texture, "Texture", [&] { ui.texture_panel.draw(ui); });
  tab(ui, Tab::profile, "Profile", [&] { ui.profile_panel.draw(ui); });
  tab(ui, Tab::reference, "Reference", [&] { ui.reference_panel.draw(ui); });
  tab(ui, Tab::messages, ui.model.problem().all().empty() ? "Messages###messages" : "Messages (!)###messages",
      [&] { draw_messages(ui); });
  ui.switch_tab = false;
  ImGui::EndTabBar();
}

}  // namespace loom::viewer
