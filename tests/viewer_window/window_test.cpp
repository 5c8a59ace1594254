// The inspector as a person meets it: a window, a mouse, keys. Pictures of the window are kept in the build folder,
// tests/viewer_window/, to be looked at.
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "support/process.h"
#include "support/temp_dir.h"
#include "viewer/app.h"
#include "viewer_window/display.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;
using viewer::App;

constexpr glm::ivec2 window_size{960, 600};  // llvmpipe fills it too

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class ViewerWindow : public testing::Test {
 protected:
  void SetUp() override {
    if (!display_.running()) GTEST_SKIP() << "no Xvfb here, so no window is tested";
    setenv("XDG_STATE_HOME", dir_.path().c_str(), 1);
    setenv("XDG_SESSION_TYPE", "x11", 1);
    fs::create_directories(kept_);
    fs::current_path(dir_.path());  // what a random key saves
    open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(96, 64)});
  }
  void open(const viewer::Options& options, glm::ivec2 size = window_size) {
    app_.reset();
    viewer::save_user_state({.size = size, .position = {0, 0}, .bookmarks = {}});
    app_ = std::make_unique<App>(options);
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

  const fs::path kept_ = LOOM_BINARY_DIR "/tests/viewer_window/pictures";
  TempDir dir_;
  VirtualDisplay display_;
  std::unique_ptr<App> app_;
  std::unique_ptr<Person> person_;
};

TEST_F(ViewerWindow, DragsTheCameraAndComesHome) {
  const auto first = picture();
  drag(view, view + glm::vec2(80, 20));
  EXPECT_FALSE(same(picture(), first)) << "orbit";
  press("Home");
  EXPECT_TRUE(same(picture(), first));
  person_->move_to(view);
  settle();
  person_->button(4, true);  // the wheel
  person_->button(4, false);
  settle();
  EXPECT_FALSE(same(picture(), first)) << "zoom";
  press("Home");
  drag(view, view + glm::vec2(40, 10), 2);
  EXPECT_FALSE(same(picture(), first)) << "pan";
  press("Home");
  drag(view, view + glm::vec2(40, 10), 3);
  EXPECT_FALSE(same(picture(), first)) << "look";
}

TEST_F(ViewerWindow, SelectsANodeOfTheGraphAndUndoesAnEdit) {
  press("1");
  const glm::vec2 node = app_->ui().graph_panel.place_of("bounce");
  ASSERT_GT(node.x, 0);
  click(node);
  EXPECT_EQ(app_->ui().selected_pass, "bounce");
  const auto first = picture();
  app_->model().set_param("tonemap", "exposure", "1");
  EXPECT_FALSE(same(picture(), first));
  press("z", "Control_L");
  EXPECT_TRUE(same(picture(), first));
  press("y", "Control_L");
  EXPECT_FALSE(same(picture(), first));
}

TEST_F(ViewerWindow, ChangesAParameterWithTheMouse) {
  const auto first = picture();
  for (float y = 80; y < 560 && !app_->model().can_undo(); y += 16) drag({810, y}, {850, y});
  ASSERT_TRUE(app_->model().can_undo()) << "no slider was met";
  const auto edited = app_->model().settings();
  EXPECT_THAT(edited, testing::Not(testing::IsEmpty()));
  while (app_->model().can_undo()) press("z", "Control_L");
  EXPECT_TRUE(same(picture(), first));
}

TEST_F(ViewerWindow, SwitchesByAClick) {
  const std::string before = app_->model().pipeline_path();
  for (float y = 90; y < 400 && app_->model().pipeline_path() == before; y += 18) click({60, y});
  EXPECT_NE(app_->model().pipeline_path(), before);
  press("z", "Control_L");
  EXPECT_EQ(app_->model().pipeline_path(), before);
}

TEST_F(ViewerWindow, OpensWhatIsDropped) {
  const std::string direct = LOOM_SOURCE_DIR "/pipelines/direct.json";
  const char* files[] = {direct.c_str()};
  GLFWwindow* window = app_->window().handle();
  const GLFWdropfun drop = glfwSetDropCallback(window, nullptr);
  glfwSetDropCallback(window, drop);
  drop(window, 1, files);
  settle();
  EXPECT_EQ(fs::path(app_->model().pipeline_path()).stem(), "direct");
  const char* bad[] = {"/etc/passwd"};
  drop(window, 1, bad);
  settle();
  EXPECT_TRUE(app_->model().problem().has_errors());
  EXPECT_EQ(fs::path(app_->model().pipeline_path()).stem(), "direct");
}

TEST_F(ViewerWindow, RestsWhenNothingChanges) {
  settle();
  const auto drawn = app_->drawn(), frames = app_->model().frames();
  const double cpu = cpu_s();
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  while (elapsed() < 1.5) app_->step(.25);
  EXPECT_EQ(app_->drawn(), drawn);
  EXPECT_EQ(app_->model().frames(), frames);
  RecordProperty("idle_cpu_percent", std::to_string(100 * (cpu_s() - cpu) / elapsed()));
  std::printf("idle: %.2f %% of a core\n", 100 * (cpu_s() - cpu) / elapsed());
}

TEST_F(ViewerWindow, SurvivesOnePixelAndComesBack) {
  open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}});
  app_->ui().divisor = 4;
  const auto resize = [&](int width, int height) {
    glfwSetWindowSize(app_->window().handle(), width, height);
    for (int i = 0; i < 20; ++i) app_->step(.02);
    settle();
  };
  resize(600, 400);
  const glm::ivec2 size = app_->model().size();
  const auto first = picture();
  resize(1, 1);
  resize(600, 400);
  EXPECT_EQ(app_->model().size(), size);
  EXPECT_TRUE(same(picture(), first));
}

TEST_F(ViewerWindow, TakesAnythingThatIsTypedAndClicked) {
  const auto first = picture();
  std::mt19937 random(6);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const std::vector<std::string> keys = {"a",        "z",      "y",   "s",     "1",        "2",
                                         "3",        "4",      "r",   "Home",  "Escape",   "Return",
                                         "question", "period", "Tab", "minus", "BackSpace"};
  const std::vector<std::string> modifiers = {"", "", "Control_L", "Shift_L"};
  for (int i = 0; i < 500; ++i) {
    const int what = below(10);
    person_->move_to({below(window_size.x), below(window_size.y)});
    if (what < 6) {
      const int button = 1 + below(5);
      person_->button(button, true);
      app_->step(0);
      person_->move_to({below(window_size.x), below(window_size.y)});
      app_->step(0);
      person_->button(button, false);
    } else if (what < 9) {
      const std::string modifier = modifiers[static_cast<std::size_t>(below(4))];
      if (!modifier.empty()) person_->key(modifier, true);
      person_->press(keys[static_cast<std::size_t>(below(static_cast<int>(keys.size())))]);
      app_->step(0);
      if (!modifier.empty()) person_->key(modifier, false);
    }
    app_->step(0);
  }
  for (int button = 1; button <= 3; ++button) person_->button(button, false);
  press("Escape");
  press("Escape");
  app_->model().playing = app_->model().continuous = false;
  app_->model().set_time(0);
  while (app_->model().can_undo()) app_->model().undo();
  app_->model().reset_camera();
  EXPECT_TRUE(same(picture(), first)) << "the way back leads to the start";
}

TEST_F(ViewerWindow, LooksReadable) {
  open({.pipeline = "lpv", .size = glm::ivec2(480, 360)}, {1440, 900});
  press("1");
  keep("graph");
  app_->model().set_param("lpv", "iterations", "6");
  app_->ui().select("lpv");
  app_->model().inspect("lpv.intensity.red");
  app_->ui().texture_panel.settings.percentiles = glm::vec2(1, 99);
  press("2");
  keep("texture");
  press("3");
  app_->model().continuous = true;
  double ui_ms = 0;
  constexpr int frames = 40;
  for (int i = 0; i < frames; ++i) {
    app_->step(0);
    ui_ms += app_->ui_ms() / frames;
  }
  std::printf("window: %.2f ms CPU a frame on the thread that draws\n", ui_ms);
  app_->model().continuous = false;
  settle();
  keep("profile");
  press("4");
  app_->ui().reference_panel.on = true;
  for (int i = 0; i < 400 && app_->ui().reference_panel.state().samples < 48; ++i) app_->step(.05);
  app_->ui().reference_panel.on = false;
  ASSERT_TRUE(app_->ui().reference_panel.state().metrics.has_value());
  EXPECT_LT(app_->ui().reference_panel.state().metrics->relmse, .2);
  EXPECT_NEAR(app_->ui().reference_panel.state().metrics->mean_ratio, 1, .3);
  settle();
  keep("reference");
  app_->model().compare_with(viewer::pipeline_file("direct"));
  settle();
  ASSERT_NE(app_->model().compared(), nullptr);
  press("1");
  keep("wipe");
  app_->model().compare_with("");
  press("question", "Shift_L");
  EXPECT_TRUE(app_->ui().show_help);
  keep("help");
  for (const char* name : {"graph", "texture", "profile", "reference", "wipe", "help"})
    EXPECT_GT(fs::file_size(kept_ / (std::string(name) + ".png")), 20000u);
}

TEST(ViewerProgram, SaysWhatToDoWithoutADisplay) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const ProcessResult result = run_loom({"view", "-p", "rsm"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, testing::HasSubstr("no-display"));
  EXPECT_THAT(result.err, testing::HasSubstr("loom render"));
}

}  // namespace
}  // namespace loom::test
