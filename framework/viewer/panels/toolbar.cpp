// The top row, the bottom row, and the keys that do the same.
#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

namespace fs = std::filesystem;

/// Right of the widget before where `width` pixels fit into the window there, else in a row of its own.
void beside(float width, bool gap) {
  const float space = gap ? ImGui::GetFontSize() : ImGui::GetStyle().ItemSpacing.x;
  const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + space + width <= end) ImGui::SameLine(0, space);
}

/// `gap`: it begins a group.
bool button(Ui& ui, const char* label, const char* tip, bool gap = false, bool enabled = true) {
  beside(ImGui::CalcTextSize(label).x + 2 * ImGui::GetStyle().FramePadding.x, gap);
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::Button(label);
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", tip);
  ui.note_place(label);
  return pressed;
}

/// A name that is not taken yet: view-000.png, view-001.png, …
std::string next_file(const std::string& stem, const std::string& extension) {
  for (int i = 0;; ++i) {
    std::string name = fmt::format("{}-{:03}{}", stem, i, extension);
    std::error_code error;
    if (!fs::exists(name, error)) return name;
  }
}

void toggle_play(Ui& ui) {
  ui.later([&model = ui.model] { model.playing = !model.playing; });
}

void step(Ui& ui) {
  constexpr double dt_s = 1. / 60;
  ui.later([&model = ui.model] {
    model.playing = false;
    model.set_time(model.time() + dt_s);
  });
}

}  // namespace

void Ui::note_place(const std::string& name) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  places[name] = {.5F * (low.x + high.x), .5F * (low.y + high.y)};
}

void take_screenshot(Ui& ui, const char* extension) {
  ui.later([&ui, extension] {
    const std::string path = next_file("view", extension);
    if (ui.model.save_picture(path)) ui.notice = "saved " + fs::absolute(path).string();
  });
}

void copy_command_line(Ui& ui) {
  ui.later([&ui] {
    const std::string command = ui.model.command_line();
    ImGui::SetClipboardText(command.c_str());
    ui.notice = "copied: " + command;
  });
}

void draw_toolbar(Ui& ui) {
  Model& model = ui.model;
  const std::string name = fs::path(model.pipeline_path()).stem().string();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(colour::accent, "%s", name.c_str());
  if (button(ui, "Undo", "Ctrl+Z", true, model.can_undo())) ui.later([&model] { model.undo(); });
  if (button(ui, "Redo", "Ctrl+Y", false, model.can_redo())) ui.later([&model] { model.redo(); });
  if (button(ui, model.playing ? "Pause" : "Play", "time of the animation (Space)", true)) toggle_play(ui);
  if (button(ui, "Step", "a sixtieth of a second (.)")) step(ui);
  if (button(ui, "Restart", "forget history and accumulated state (R)")) ui.later([&model] { model.reset(); });
  bool continuous = model.continuous;
  constexpr const char* keep = "keep rendering";
  beside(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x + ImGui::CalcTextSize(keep).x, false);
  if (ImGui::Checkbox(keep, &continuous)) ui.later([&model, continuous] { model.continuous = continuous; });
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("render on though nothing changes; otherwise a pipeline with\nstate gets %d frames to settle",
                      settle_frames);
  ui.note_place(keep);
  if (button(ui, "Save as…", "a pipeline with what differs (Ctrl+S)", true)) ui.save_dialog = true;
  if (button(ui, "PNG", "the picture (F12)")) take_screenshot(ui, ".png");
  if (button(ui, "EXR", "radiance (Shift+F12)")) take_screenshot(ui, ".exr");
  if (button(ui, "Copy command", "a command line that renders this view (Ctrl+Shift+C)")) copy_command_line(ui);
  const float width = ImGui::GetFontSize() * 4;
  beside(width, true);
  ImGui::SetNextItemWidth(width);
  constexpr const char* shares[] = {"1/1", "1/2", "1/4"};
  int share = ui.divisor == 1 ? 0 : ui.divisor == 2 ? 1 : 2;
  ImGui::BeginDisabled(ui.fixed_size);
  if (ImGui::Combo("##share", &share, shares, 3)) ui.divisor = 1 << share;
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    ImGui::SetTooltip(ui.fixed_size ? "the frame has the size of --size or the run file"
                                    : "frame size as a share of the view's");
  if (button(ui, "?", "keys and gestures (?)", true)) ui.show_help = true;
}

void draw_status(Ui& ui) {
  Model& model = ui.model;
  const Diagnostics& problem = model.problem();
  if (!problem.all().empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour::error);
    const std::string first = to_string(problem.all().front());
    const std::string line = first.substr(0, first.find('\n'));
    if (ImGui::Selectable((line + "###problem").c_str())) ui.open_tab(Tab::messages);
    ImGui::PopStyleColor();
    return;
  }
  const graph::FrameTimes& times = model.frame_times();
  const glm::ivec2 size = model.size();
  std::string text =
      fmt::format("{}×{}   {:.2f} ms GPU, {:.2f} ms wall   {:.1f} MiB   {}", size.x, size.y, times.gpu_median_ms,
                  times.wall_median_ms, static_cast<double>(model.live().graph().bytes) / (1 << 20), model.device());
  if (model.animated() || model.time() > 0) text = fmt::format("t = {:.2f} s   ", model.time()) + text;
  if (!ui.notice.empty()) {
    ImGui::TextColored(colour::good, "%s", ui.notice.c_str());
    ImGui::SameLine(0, ImGui::GetFontSize());
  }
  ImGui::TextDisabled("%s", text.c_str());
}

void draw_save_dialog(Ui& ui) {
  static constexpr const char* title = "Save as pipeline";
  if (ui.save_dialog) {
    ImGui::OpenPopup(title);
    ui.save_dialog = false;
  }
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  static std::string path = "mine.json";
  ImGui::TextUnformatted("Only what differs is written; the file extends the open pipeline.");
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 28);
  const bool entered = ImGui::InputText("##path", &path, ImGuiInputTextFlags_EnterReturnsTrue);
  if (ImGui::Button("Save") || entered) {
    ui.later([&ui, to = path] {
      if (ui.model.save_pipeline(to)) ui.notice = "saved " + fs::absolute(to).string();
    });
    ImGui::CloseCurrentPopup();
  }
  ImGui::SameLine();
  if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(GLFW_KEY_ESCAPE)) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

void handle_shortcuts(Ui& ui) {
  const ImGuiIO& io = ImGui::GetIO();
  Model& model = ui.model;
  for (const ImWchar c : io.InputQueueCharacters)
    if (c == '?' && !io.WantTextInput) ui.show_help = !ui.show_help;
  if (io.WantTextInput) return;
  const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
  if (io.KeyCtrl) {
    if (ImGui::IsKeyPressed(GLFW_KEY_Z)) ui.later([&model, redo = io.KeyShift] { redo ? model.redo() : model.undo(); });
    if (ImGui::IsKeyPressed(GLFW_KEY_Y)) ui.later([&model] { model.redo(); });
    if (pressed(GLFW_KEY_S)) ui.save_dialog = true;
    if (pressed(GLFW_KEY_C) && io.KeyShift) copy_command_line(ui);
    return;
  }
  if (pressed(GLFW_KEY_SPACE)) toggle_play(ui);
  if (ImGui::IsKeyPressed(GLFW_KEY_PERIOD)) step(ui);
  if (pressed(GLFW_KEY_L)) ui.light_handles.on = !ui.light_handles.on;
  if (pressed(GLFW_KEY_R)) ui.later([&model] { model.reset(); });
  if (pressed(GLFW_KEY_HOME)) ui.later([&model] { model.reset_camera(); });
  if (pressed(GLFW_KEY_F12)) take_screenshot(ui, io.KeyShift ? ".exr" : ".png");
  if (pressed(GLFW_KEY_F11)) capture_frame(ui);
  constexpr Tab tabs[] = {Tab::graph, Tab::texture, Tab::profile, Tab::reference, Tab::messages};
  for (int i = 0; i < 5; ++i)
    if (pressed(GLFW_KEY_1 + i)) ui.open_tab(tabs[i]);
  if (pressed(GLFW_KEY_ESCAPE)) ui.show_help = false;
}

}  // namespace loom::viewer
