#pragma once
// The inspector as a person meets it: a window, a mouse, keys. Pictures of the window are kept in the build folder,
// tests/viewer_window/pictures, to be looked at; with LOOM_UPDATE_EXPECTED=1 those of the documentation are made anew.
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "support/temp_dir.h"
#include "viewer/app.h"
#include "viewer_window/display.h"

namespace loom::test {

namespace fs = std::filesystem;

constexpr glm::ivec2 window_size{960, 600};  // llvmpipe fills it too

class ViewerWindow : public testing::Test {
 protected:
  void SetUp() override {
    if (!display_.running()) GTEST_SKIP() << "no Xvfb here, so no window is tested";
    setenv("XDG_STATE_HOME", dir_.path().c_str(), 1);
    setenv("XDG_SESSION_TYPE", "x11", 1);
    // Most of the time goes into compiling programs that draw a few pixels.
    setenv("GALLIVM_PERF", "nopt", 0);
    fs::create_directories(kept_);
    fs::current_path(dir_.path());  // what a random key saves
    open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(96, 64)});
  }
  void open(const viewer::Options& options, glm::ivec2 size = window_size) {
    app_.reset();
    viewer::save_user_state({.size = size, .position = {0, 0}, .bookmarks = {}});
    app_ = std::make_unique<viewer::App>(options);
    person_ = std::make_unique<Person>();
    settle();
  }
  /// Until nothing has been done for a while: events have come, frames are drawn.
  void settle() {
    for (int i = 0, quiet = 0; i < 200 && quiet < 2; ++i) {
      const auto before = app_->drawn();
      app_->step(.04);
      quiet = app_->drawn() == before && !app_->model().frame_due() ? quiet + 1 : 0;
    }
  }
  /// A press that is held over a frame, as fingers do: two states within one frame would be none.
  void click(glm::vec2 place) {
    person_->move_to(place);
    settle();
    person_->button(1, true);
    settle();
    person_->button(1, false);
    settle();
  }
  void press(const std::string& key, const std::string& modifier = {}) {
    if (!modifier.empty()) person_->key(modifier, true);
    person_->key(key, true);
    settle();
    person_->key(key, false);
    if (!modifier.empty()) person_->key(modifier, false);
    settle();
  }
  void drag(glm::vec2 from, glm::vec2 to, int button = 1) {
    person_->move_to(from);
    settle();
    person_->button(button, true);
    settle();
    person_->move_to(to);
    settle();
    person_->button(button, false);
    settle();
  }
  void drop(const std::string& file) {
    const char* files[] = {file.c_str()};
    GLFWwindow* window = app_->window().handle();
    const GLFWdropfun callback = glfwSetDropCallback(window, nullptr);
    glfwSetDropCallback(window, callback);
    callback(window, 1, files);
    settle();
  }
  void walk(int deeds);
  void steps(int count) {
    for (int i = 0; i < count; ++i) app_->step(0);
  }
  glm::vec2 row(const std::string& pipeline) { return app_->ui().places[pipeline]; }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void keep(const std::string& name) {
    app_->window().before_swap = [&] { app_->window().capture((kept_ / (name + ".png")).string()); };
    app_->redraw();
    app_->step(0);
    app_->window().before_swap = nullptr;
  }
  std::vector<glm::vec4> picture() {
    settle();
    return app_->model().live().renderer().read("image").texels;
  }
  static bool same(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) { return a == b; }
  /// Middle of the view, and of a row of the list on the left.
  static constexpr glm::vec2 view{430, 180};

  const fs::path kept_ = std::getenv("LOOM_UPDATE_EXPECTED") != nullptr ? LOOM_SOURCE_DIR "/docs/images/inspector"
                                                                        : LOOM_BINARY_DIR
                             "/tests/viewer_window/pictures";
  TempDir dir_;
  VirtualDisplay display_;
  std::unique_ptr<viewer::App> app_;
  std::unique_ptr<Person> person_;
};

}  // namespace loom::test
