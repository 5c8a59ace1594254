// The inspector in the hands of a person: camera, parameters, lights, textures, sizes, anything typed and clicked.
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "support/process.h"
#include "viewer_window/window_test.h"

namespace loom::test {

/// A person without a plan, and the way back.
void ViewerWindow::walk(int deeds) {
  const auto first = picture();
  std::mt19937 random(6);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const std::vector<std::string> keys = {"a",        "z",      "y",   "s",     "1",        "2",
                                         "3",        "4",      "r",   "Home",  "Escape",   "Return",
                                         "question", "period", "Tab", "minus", "BackSpace"};
  const std::vector<std::vector<const char*>> numbers = {
      {"9", "e", "9"}, {"minus", "9", "e", "9", "9"}, {"n", "a", "n"}, {"i", "n", "f"}};
  const std::vector<std::string> modifiers = {"", "", "Control_L", "Shift_L"};
  for (int i = 0; i < deeds; ++i) {
    const int what = below(10);
    person_->move_to({below(window_size.x), below(window_size.y)});
    if (what < 6) {
      const int button = 1 + below(5);
      person_->button(button, true);
      app_->step(0);
      person_->move_to({below(window_size.x), below(window_size.y)});
      app_->step(0);
      person_->button(button, false);
    } else if (what == 6) {
      // A number in place of a slider.
      person_->key("Control_L", true);
      person_->button(1, true);
      app_->step(0);
      person_->button(1, false);
      person_->key("Control_L", false);
      app_->step(0);
      for (const char* key : numbers[static_cast<std::size_t>(below(4))]) person_->press(key);
      app_->step(0);
      person_->press("Return");
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

namespace {

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

TEST_F(ViewerWindow, MovesALightByItsHandle) {
  const auto first = picture();
  const glm::dvec3 before = app_->model().setup().scene.lights.at(0).position;
  press("l");
  const auto handle = [&](viewer::HandleKind kind) { return app_->ui().light_handles.place_of(0, kind); };
  const glm::vec2 along = handle(viewer::HandleKind::axis_x), centre = handle(viewer::HandleKind::centre);
  ASSERT_GT(along.x, 0);
  drag(along, along + .8F * (along - centre));
  const glm::dvec3 after = app_->model().setup().scene.lights.at(0).position;
  EXPECT_GT(after.x, before.x + .01) << "where the handle points";
  EXPECT_EQ(after.y, before.y);
  EXPECT_EQ(after.z, before.z);
  EXPECT_EQ(app_->model().camera().eye, app_->model().setup().camera.eye) << "the view stays";
  EXPECT_FALSE(same(picture(), first));
  press("z", "Control_L");
  EXPECT_FALSE(app_->model().can_undo()) << "a drag is one step";
  EXPECT_TRUE(same(picture(), first));
}

TEST_F(ViewerWindow, ReadsATextureOnlyWhenItChanged) {
  press("2");
  app_->model().inspect("gbuffer.surface.normal");
  settle();
  const auto reads = app_->ui().texture_panel.reads();
  EXPECT_GT(reads, 0u);
  app_->model().set_param("tonemap", "exposure", "1");
  settle();
  person_->move_to({500, 450});
  settle();
  EXPECT_EQ(app_->ui().texture_panel.reads(), reads) << "the pass kept its outputs";
  app_->ui().texture_panel.settings.exposure = 1;
  app_->redraw();
  settle();
  EXPECT_EQ(app_->ui().texture_panel.reads(), reads) << "another look at the same texels";
  drag(view, view + glm::vec2(80, 20));
  EXPECT_GT(app_->ui().texture_panel.reads(), reads);
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

TEST_F(ViewerWindow, AWindowOf640PixelsCutsNoButton) {
  const std::vector<std::string> buttons = {"Undo",     "Redo", "Play", "Step",         "Restart", "keep rendering",
                                            "Save as…", "PNG",  "EXR",  "Copy command", "?"};
  const auto place = [&](const std::string& name) { return app_->ui().places.at(name); };
  open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(96, 64)}, {1400, 600});
  for (const std::string& name : buttons) EXPECT_EQ(place(name).y, place("Undo").y) << name << ": one row suffices";
  open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(96, 64)}, {640, 480});
  for (const std::string& name : buttons) {
    EXPECT_GT(place(name).x, 0) << name;
    EXPECT_LT(place(name).x, 640 - ImGui::CalcTextSize(name.c_str()).x / 2) << name;
  }
  EXPECT_GT(place("?").y, place("Undo").y) << "a second row";
  keep("narrow");
  click(place("?"));
  EXPECT_TRUE(app_->ui().show_help) << "it is there to be clicked";
}

TEST_F(ViewerWindow, TwiceTheDotsAnInchAreTwiceThePixels) {
  const viewer::Options options{.pipeline = "gbuffer", .size = glm::ivec2(24, 16)};
  const auto value_at = [&](glm::ivec2 texel) {
    app_->model().inspect("gbuffer.surface.normal");
    press("2");
    const auto& panel = app_->ui().texture_panel;
    EXPECT_GE(panel.texel_size(), 1);
    // The first whole pixel within the texel: pointers stand on whole ones.
    person_->move_to(glm::ceil(panel.picture_at() + glm::vec2(texel) * panel.texel_size()));
    settle();
    return panel.said().substr(0, panel.said().find("shown"));
  };
  open(options, {740, 460});
  const float font = ImGui::GetFontSize(), frame = ImGui::GetFrameHeight();
  const glm::vec2 undo = app_->ui().places.at("Undo");
  const std::string value = value_at({6, 3});
  EXPECT_THAT(value, testing::StartsWith("(6, 12)")) << "rows count from below";
  app_.reset();
  display_.set_dots_per_inch(192);
  open(options, {1480, 920});
  EXPECT_EQ(app_->window().scale(), 2);
  EXPECT_NEAR(ImGui::GetFontSize(), 2 * font, 1);
  EXPECT_NEAR(ImGui::GetFrameHeight(), 2 * frame, 2);
  EXPECT_NEAR(app_->ui().places.at("Undo").x, 2 * undo.x, 6);
  EXPECT_NEAR(app_->ui().places.at("Undo").y, 2 * undo.y, 3);
  EXPECT_EQ(value_at({6, 3}), value) << "the same texel under the pointer";
  keep("high-dpi");
  // To a screen of 96 dots an inch and back, as the window system says it.
  GLFWwindow* window = app_->window().handle();
  const GLFWwindowcontentscalefun callback = glfwSetWindowContentScaleCallback(window, nullptr);
  glfwSetWindowContentScaleCallback(window, callback);
  ASSERT_NE(callback, nullptr);
  callback(window, 1, 1);
  app_->redraw();
  settle();
  EXPECT_EQ(app_->window().scale(), 1);
  EXPECT_NEAR(ImGui::GetFontSize(), font, .5);
  EXPECT_NEAR(ImGui::GetFrameHeight(), frame, 1);
  EXPECT_EQ(value_at({6, 3}), value);
  callback(window, 2, 2);
  app_->redraw();
  settle();
  EXPECT_NEAR(ImGui::GetFontSize(), 2 * font, 1);
}

TEST_F(ViewerWindow, ShowsABufferAsATable) {
  open({.pipeline = "instant-radiosity", .set = {{"vpls", "paths", "64"}}, .size = glm::ivec2(24, 16)});
  app_->model().inspect("vpls.vpls.lights");
  press("2");
  settle();
  const viewer::BufferPage& page = app_->ui().texture_panel.table().page();
  EXPECT_TRUE(page.layout.known);
  EXPECT_GT(page.rows, 20u);
  EXPECT_EQ(page.not_finite, 0u);
  keep("buffer");
}

TEST_F(ViewerWindow, TakesAnythingThatIsTypedAndClicked) { walk(120); }
// Most of what a longer walk meets, a shorter one has met: build/bin/test_viewer_window --gtest_filter='Slow*'
class SlowViewerWindow : public ViewerWindow {};
TEST_F(SlowViewerWindow, TakesAnythingThatIsTypedAndClickedForLong) { walk(2000); }

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
