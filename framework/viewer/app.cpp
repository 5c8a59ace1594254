#include "viewer/app.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "gpu/context.h"
#include "viewer/theme.h"

namespace loom::viewer {
namespace {

constexpr double poll_every_s = .25;   ///< files: a person does not notice less, and it costs next to nothing
constexpr double size_settles_s = .1;  ///< a window that is dragged changes size many times
constexpr int redraws_after_event = 3;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double thread_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

bool child(const char* name, ImVec2 size, ImGuiWindowFlags flags = 0) {
  return ImGui::BeginChild(name, size, true, flags);
}

}  // namespace

App::App(const Options& options)
    : user_(load_user_state()),
      window_({.title = "Lightloom", .size = user_.size, .position = user_.position, .font_scale = user_.font_scale}),
      model_(options),
      ui_{.model = model_, .user = user_} {
  ui_.fixed_size = options.size.has_value() || model_.setup().size.has_value();
  if (gpu::is_software_device()) ui_.divisor = 2;
  last_s_ = now_s();
}

App::~App() {
  user_.size = window_.size();
  user_.position = window_.position();
  save_user_state(user_);
}

void App::run() {
  while (!window_.should_close()) step(poll_every_s);
}

void App::step(double wait_s) {
  const bool size_pending = !ui_.fixed_size && wanted_size_ != model_.size() && wanted_size_.x > 0;
  const bool busy = redraws_ > 0 || model_.frame_due() || size_pending;
  if (window_.wait(busy ? 0 : wait_s)) redraws_ = redraws_after_event;
  for (const std::string& file : window_.dropped()) guarded([&] { open_dropped(file); });
  const double now = now_s();
  if (now - polled_s_ > poll_every_s) {
    polled_s_ = now;
    guarded([&] {
      if (model_.poll_files()) redraws_ = redraws_after_event;
    });
  }
  follow_size(now);
  guarded([&] {
    if (ui_.reference_panel.follow(ui_)) redraws_ = redraws_after_event;
  });
  const double dt = std::clamp(now - last_s_, 0., .1);
  last_s_ = now;
  if (model_.frame_due()) {
    guarded([&] { model_.frame(dt); });
    redraws_ = std::max(redraws_, 1);
  }
  if (ui_.texture_panel.wants_redraw()) redraws_ = std::max(redraws_, 1);
  if (redraws_ == 0) return;
  --redraws_;
  draw();
}

void App::open_dropped(const std::string& path) {
  if (report_file(path).empty()) {
    model_.open_any(path);
    return;
  }
  ui_.reference_panel.plot.load(path, model_.scene_path());
  ui_.open_tab(Tab::reference);
}

/// A window outlives whatever goes wrong in it.
void App::guarded(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    ui_.notice = error.what();
    redraws_ = redraws_after_event;
  }
}

void App::follow_size(double now) {
  if (ui_.fixed_size || ui_.view_size.x <= 0) return;
  const glm::ivec2 size = glm::max(ui_.view_size / ui_.divisor, glm::ivec2(1));
  if (size != wanted_size_) {
    wanted_size_ = size;
    resized_s_ = now;
  }
  if (wanted_size_ != model_.size() && now - resized_s_ >= size_settles_s) {
    if (!model_.resize(wanted_size_)) wanted_size_ = model_.size();
    redraws_ = redraws_after_event;
  }
}

void App::draw() {
  guarded([&] {
    ui_.overlay.update(model_, ui_.texture_panel.volume, ui_.texture_panel.settings, glm::ivec2(ui_.picture_size));
  });
  const double start = thread_cpu_ms();
  window_.set_title("Lightloom – " + std::filesystem::path(model_.pipeline_path()).stem().string());
  window_.begin_frame();
  layout();
  window_.end_frame();
  ui_ms_ = thread_cpu_ms() - start;
  ++drawn_;
  run_pending();
}

void App::run_pending() {
  if (ui_.pending.empty()) return;
  for (const auto& work : std::exchange(ui_.pending, {})) guarded(work);
  redraws_ = redraws_after_event;
}

void App::layout() {
  handle_shortcuts(ui_);
  const ImGuiViewport* viewport = ImGui::GetMainViewport();
  ImGui::SetNextWindowPos(viewport->WorkPos);
  ImGui::SetNextWindowSize(viewport->WorkSize);
  ImGui::Begin("##lightloom", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoSavedSettings);
  const float unit = ImGui::GetFontSize();
  draw_toolbar(ui_);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float status = ImGui::GetFrameHeightWithSpacing();
  const float height = std::max(room.y - status, 1.F);
  const float left = std::min(17 * unit, .2F * room.x);
  const float right = std::min(25 * unit, .3F * room.x);
  const float middle = std::max(room.x - left - right - 2 * ImGui::GetStyle().ItemSpacing.x, 1.F);

  if (child("left", {left, height})) {
    if (ImGui::BeginTabBar("left tabs")) {
      if (ImGui::BeginTabItem("Pipelines")) {
        draw_pipelines(ui_);
        ImGui::EndTabItem();
      }
      const bool scene = ImGui::BeginTabItem("Scene");
      ui_.note_place("scene");
      if (scene) {
        draw_scene(ui_);
        ImGui::EndTabItem();
      }
      ImGui::EndTabBar();
    }
  }
  ImGui::EndChild();

  ImGui::SameLine();
  ImGui::BeginGroup();
  const float upper = .58F * height;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  if (child("view", {middle, upper}, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse)) draw_view(ui_);
  ImGui::EndChild();
  ImGui::PopStyleVar();
  if (child("lower", {middle, height - upper - ImGui::GetStyle().ItemSpacing.y})) draw_lower_tabs(ui_);
  ImGui::EndChild();
  ImGui::EndGroup();

  ImGui::SameLine();
  if (child("parameters", {right, height})) draw_parameters(ui_);
  ImGui::EndChild();
  draw_status(ui_);
  draw_save_dialog(ui_);
  ImGui::End();
  draw_help(ui_);
}

}  // namespace loom::viewer
