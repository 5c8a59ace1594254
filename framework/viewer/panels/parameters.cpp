// Every pass with its parameters: widgets made from the declarations.
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <limits>
#include <string>
#include <variant>

#include "viewer/theme.h"
#include "viewer/ui.h"
#include "viewer/values.h"

namespace loom::viewer {
namespace {

constexpr ImGuiSliderFlags typed_is_clamped = ImGuiSliderFlags_AlwaysClamp;

const char* cost_text(Cost cost) {
  switch (cost) {
    case Cost::live:
      return "takes effect at once";
    case Cost::shader:
      return "compiles the pass's shader again";
    case Cost::graph:
      break;
  }
  return "compiles the graph again";
}

std::string range_text(const ParamDecl& decl) {
  if (decl.kind != ParamKind::integer && decl.kind != ParamKind::real && decl.kind != ParamKind::colour) return {};
  return fmt::format("{:g} … {:g}{}{}", decl.min, decl.max, decl.unit.empty() ? "" : " ", decl.unit);
}

void tooltip(const ParamDecl& decl, const ParamValue* in_file) {
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 26);
  ImGui::TextColored(colour::accent, "%s", decl.name.c_str());
  ImGui::TextUnformatted(decl.doc.c_str());
  if (const std::string range = range_text(decl); !range.empty()) ImGui::TextDisabled("%s", range.c_str());
  ImGui::TextDisabled("default %s%s%s", json_text(decl.default_value).c_str(),
                      in_file != nullptr ? ", in the file " : "",
                      in_file != nullptr ? json_text(*in_file).c_str() : "");
  ImGui::TextDisabled("%s", cost_text(decl.cost));
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool edit_integer(const ParamDecl& decl, int& value) {
  constexpr double half = std::numeric_limits<int>::max() / 2.;
  const int min = static_cast<int>(std::max(decl.min, -half)), max = static_cast<int>(std::min(decl.max, half));
  const ImGuiSliderFlags log = decl.scale == Scale::log && min > 0 ? ImGuiSliderFlags_Logarithmic : 0;
  const std::string format = "%d" + (decl.unit.empty() ? "" : " " + decl.unit);
  return ImGui::SliderInt("##value", &value, min, max, format.c_str(), typed_is_clamped | log);
}

bool edit_real(const ParamDecl& decl, float& value) {
  constexpr double half = std::numeric_limits<float>::max() / 2.;
  const auto min = static_cast<float>(std::max(decl.min, -half)), max = static_cast<float>(std::min(decl.max, half));
  const ImGuiSliderFlags log = decl.scale == Scale::log ? ImGuiSliderFlags_Logarithmic : 0;
  const std::string format = "%.4g" + (decl.unit.empty() ? "" : " " + decl.unit);
  return ImGui::SliderFloat("##value", &value, min, max, format.c_str(), typed_is_clamped | log);
}

bool edit_choice(const ParamDecl& decl, std::string& value) {
  bool chosen = false;
  if (!ImGui::BeginCombo("##value", value.c_str())) return false;
  for (const std::string& choice : decl.choices) {
    if (ImGui::Selectable(choice.c_str(), choice == value)) {
      value = choice;
      chosen = true;
    }
  }
  ImGui::EndCombo();
  return chosen;
}

/// True where a person changed the value.
bool edit(const ParamDecl& decl, ParamValue& value) {
  switch (decl.kind) {
    case ParamKind::boolean:
      return ImGui::Checkbox("##value", &std::get<bool>(value));
    case ParamKind::integer:
      return edit_integer(decl, std::get<int>(value));
    case ParamKind::real:
      return edit_real(decl, std::get<float>(value));
    case ParamKind::choice:
      return edit_choice(decl, std::get<std::string>(value));
    case ParamKind::text:
      return ImGui::InputText("##value", &std::get<std::string>(value), ImGuiInputTextFlags_EnterReturnsTrue);
    case ParamKind::colour:
      break;
  }
  return ImGui::ColorEdit3("##value", &std::get<glm::vec3>(value).x,
                           ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
}

void draw_one(Ui& ui, const graph::CompiledPass& pass, const ParamDecl& decl) {
  Model& model = ui.model;
  const std::string path = pass.name + "." + decl.name;
  const bool changed = model.is_changed(pass.name, decl.name);
  ImGui::PushID(decl.name.c_str());
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(changed ? colour::changed : ImGui::GetStyleColorVec4(ImGuiCol_Text), "%s", decl.name.c_str());
  if (ImGui::IsItemHovered()) tooltip(decl, model.live().value_in_file(path));

  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-std::numeric_limits<float>::min());
  ParamValue value = Params::value_of(decl);
  if (edit(decl, value))
    ui.later([&model, pass = pass.name, param = decl.name, text = json_text(value), path] {
      model.set_param(pass, param, text, path);
    });
  if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) tooltip(decl, model.live().value_in_file(path));
  if (ImGui::IsItemDeactivated()) ui.later([&model] { model.end_gesture(); });

  ImGui::TableNextColumn();
  if (changed) {
    if (ImGui::SmallButton("↺"))
      ui.later([&model, pass = pass.name, param = decl.name] { model.reset_param(pass, param); });
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("back to what the file says");
  }
  ImGui::PopID();
}

void draw_pass(Ui& ui, const graph::CompiledPass& pass) {
  const bool selected = pass.name == ui.selected_pass;
  const auto& decls = pass.params.all();
  if (!pass.runs) ImGui::PushStyleColor(ImGuiCol_Text, colour::dim);
  if (selected) ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetStyleColorVec4(ImGuiCol_HeaderActive));
  if (selected && ui.scroll_to_selected) {
    ImGui::SetNextItemOpen(true);
    ImGui::SetScrollHereY(.1F);
    ui.scroll_to_selected = false;
  }
  const auto flags = decls.empty() ? ImGuiTreeNodeFlags_Leaf : ImGuiTreeNodeFlags_DefaultOpen;
  const std::string title = pass.name == pass.type ? pass.name : pass.name + "  ·  " + pass.type;
  const bool open = ImGui::CollapsingHeader((title + "###" + pass.name).c_str(), flags);
  if (ImGui::IsItemClicked()) ui.selected_pass = pass.name;
  if (selected) ImGui::PopStyleColor();
  if (!pass.runs) ImGui::PopStyleColor();
  if (!open || decls.empty()) return;
  if (!ImGui::BeginTable(pass.name.c_str(), 3, ImGuiTableFlags_SizingStretchProp)) return;
  const float unit = ImGui::GetFontSize();
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, .42F);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, .58F);
  ImGui::TableSetupColumn("reset", ImGuiTableColumnFlags_WidthFixed, 1.4F * unit);
  for (const ParamDecl& decl : decls) draw_one(ui, pass, decl);
  ImGui::EndTable();
}

}  // namespace

void draw_parameters(Ui& ui) {
  const std::size_t count = ui.model.settings().size();
  ImGui::TextDisabled(count == 1 ? "%zu value differs from the file" : "%zu values differ from the file", count);
  for (const graph::CompiledPass& pass : ui.model.live().graph().passes) {
    ImGui::PushID(pass.name.c_str());
    draw_pass(ui, pass);
    ImGui::PopID();
  }
}

}  // namespace loom::viewer
