// The inspector and files: pipelines, scenes, shaders and plugins that are opened, dropped and changed.
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "measure/sweep/result.h"
#include "scene/gltf_builder.h"
#include "viewer_window/window_test.h"

namespace loom::test {
namespace {

TEST_F(ViewerWindow, OpensWhatIsDropped) {
  drop(LOOM_SOURCE_DIR "/pipelines/direct.json");
  EXPECT_EQ(fs::path(app_->model().pipeline_path()).stem(), "direct");
  for (const char* bad : {"/etc/passwd", "/nowhere/x.glb", "/nowhere/report.json", "/"}) {
    app_->model().dismiss_problem();
    app_->ui().notice.clear();
    drop(bad);
    EXPECT_TRUE(app_->model().problem().has_errors() || !app_->ui().notice.empty()) << bad;
    EXPECT_EQ(fs::path(app_->model().pipeline_path()).stem(), "direct");
  }
  drop(dir_.write("tri.gltf", GltfBuilder().triangle().text()));
  EXPECT_EQ(app_->model().facts().triangles, 1u);
  measure::Result point{.key = "a", .scene = "tri", .pipeline = "direct", .size = {64, 64}};
  point.gpu_ms = {2, 2};
  point.errors["hdr"] = {.relmse = .25};
  nlohmann::ordered_json report;
  report["points"].push_back(measure::to_json(point));
  drop(dir_.write("report.json", report.dump()));
  ASSERT_TRUE(app_->ui().reference_panel.plot.report());
  EXPECT_EQ(app_->ui().reference_panel.plot.report()->points.size(), 1u);
  EXPECT_EQ(app_->ui().tab, viewer::Tab::reference);
}

TEST_F(ViewerWindow, SwitchesThroughAllPipelinesByClicks) {
  const std::string scene = dir_.write("tri.gltf", GltfBuilder().triangle().text());  // for which little is run
  open({.scene = scene, .pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(16, 12)}, {640, 480});
  const auto first = picture();
  const std::string start = app_->model().pipeline_path();
  const std::vector<std::string> pipelines = app_->model().pipelines();
  EXPECT_GT(pipelines.size(), 20u);
  for (const std::string& path : pipelines) {
    // Below the edge of the list, the wheel brings it up.
    person_->move_to({60, 200});
    for (int i = 0; i < 60 && !(row(path).y > 90 && row(path).y < 400); ++i) {
      const int button = row(path).y < 200 ? 4 : 5;
      person_->button(button, true);
      person_->button(button, false);
      steps(2);  // the list moves in the window after the one that hears of it
    }
    person_->move_to(row(path));
    steps(1);
    person_->button(1, true);
    steps(1);
    person_->button(1, false);
    const auto frames = app_->model().frames();
    for (int i = 0; i < 20 && (app_->model().pipeline_path() != path || app_->model().frames() == frames); ++i)
      app_->step(.01);
    ASSERT_EQ(app_->model().pipeline_path(), path);
    EXPECT_FALSE(app_->model().problem().has_errors()) << path;
    for (const glm::vec4& texel : app_->model().live().renderer().read("image").texels)
      ASSERT_TRUE(std::isfinite(texel.r + texel.g + texel.b)) << path;
  }
  while (app_->model().can_undo()) app_->model().undo();
  EXPECT_EQ(app_->model().pipeline_path(), start);
  EXPECT_TRUE(same(picture(), first)) << "undone to the start";
}

TEST_F(ViewerWindow, ReloadsABrokenShaderAndAGoodOne) {
  const std::string good = text_of(LOOM_SOURCE_DIR "/shaders/tonemap/tonemap.comp");
  fs::create_directories(dir_ / "shaders/tonemap");
  const std::string file = dir_.write("shaders/tonemap/tonemap.comp", good);
  setenv("LOOM_SHADER_PATH", (dir_ / "shaders").c_str(), 1);
  open({.pipeline = "rsm", .set = {{"rsm", "size", "32"}}, .size = glm::ivec2(96, 64)});
  unsetenv("LOOM_SHADER_PATH");
  const auto first = picture();
  const auto save = [&](const std::string& text) {
    const auto before = fs::last_write_time(file);
    std::ofstream(file, std::ios::trunc) << text;
    fs::last_write_time(file, before + std::chrono::seconds(2));
    for (int i = 0; i < 12; ++i) app_->step(.05);
  };
  save(good + "\nnonsense\n");
  ASSERT_TRUE(app_->model().problem().has_errors());
  EXPECT_TRUE(same(app_->model().live().renderer().read("image").texels, first)) << "the last good picture stays";
  click({200, 588});  // the bottom line leads to the messages
  EXPECT_EQ(app_->ui().tab, viewer::Tab::messages);
  click({260, 425});
  EXPECT_THAT(glfwGetClipboardString(app_->window().handle()), testing::HasSubstr("tonemap.comp:"));
  save(good);
  EXPECT_FALSE(app_->model().problem().has_errors());
  EXPECT_TRUE(same(picture(), first));
}

TEST_F(ViewerWindow, APluginIsSwappedUnderIt) {
  fs::create_directories(dir_ / "plugins");
  const fs::path plugin = dir_ / "plugins/flat.so";
  fs::copy_file(FLAT_DIR "/plugin_flat_1.so", plugin);
  const std::string file = dir_.write(
      "flat.json", R"({"name": "flat", "passes": {"flat": {"type": "Flat"}}, "outputs": {"image": "flat.image"}})");
  open({.pipeline = file, .size = glm::ivec2(16, 12), .plugin_dirs = {dir_ / "plugins"}}, {640, 480});
  EXPECT_FLOAT_EQ(picture().front().r, .1F);
  const auto before = fs::last_write_time(plugin);
  fs::copy_file(FLAT_DIR "/plugin_flat_2.so", plugin, fs::copy_options::overwrite_existing);
  fs::last_write_time(plugin, before + std::chrono::seconds(2));
  for (int i = 0; i < 12; ++i) app_->step(.05);
  EXPECT_FLOAT_EQ(picture().front().r, .2F);
}

TEST_F(ViewerWindow, PlaysPausesAndSteps) {
  GltfBuilder moving;
  moving.triangle();
  const int times = moving.accessor<float>("SCALAR", 1, {0, 1}),
            places = moving.accessor<float>("VEC3", 3, {0, 0, 0, 9, 0, 0});
  moving.json["animations"] = nlohmann::json::array(
      {{{"samplers", nlohmann::json::array({{{"input", times}, {"output", places}}})},
        {"channels", nlohmann::json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}}});
  open({.scene = dir_.write("moving.gltf", moving.text()), .pipeline = "gbuffer", .size = glm::ivec2(48, 32)});
  ASSERT_TRUE(app_->model().animated());
  const auto first = picture();
  const auto space = [&] {
    for (const bool down : {true, false}) {
      person_->key("space", down);
      for (int i = 0; i < 6; ++i) app_->step(.01);
    }
  };
  space();
  EXPECT_TRUE(app_->model().playing);
  space();
  EXPECT_FALSE(app_->model().playing);
  const double time = app_->model().time();
  EXPECT_GT(time, 0);
  EXPECT_FALSE(same(picture(), first)) << "it has moved";
  EXPECT_EQ(app_->model().time(), time) << "it stands";
  press("period");
  EXPECT_NEAR(app_->model().time(), time + 1. / 60, 1e-9);
}

TEST_F(ViewerWindow, KeepsBookmarksAndCopiesTheCommand) {
  drag(view, view + glm::vec2(60, 10));
  const scene::Camera marked = app_->model().camera();
  click(app_->ui().places["scene"]);
  click(app_->ui().places["bookmark"]);
  const auto& marks = app_->ui().user.bookmarks[app_->model().scene_path()];
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0].camera.eye, marked.eye);
  person_->key("Shift_L", true);
  press("c", "Control_L");
  person_->key("Shift_L", false);
  const std::string command = glfwGetClipboardString(app_->window().handle());
  EXPECT_THAT(command, testing::StartsWith("loom render "));
  EXPECT_THAT(command, testing::HasSubstr("rsm.size=32"));
  app_.reset();
  EXPECT_EQ(viewer::load_user_state().bookmarks[""].at(0).camera.eye, marked.eye);
}

}  // namespace
}  // namespace loom::test
