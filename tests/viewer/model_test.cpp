// The inspector without its window: edits, undo, switching, hot reload, what it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "interop/vpl.h"
#include "loom/gpu.h"
#include "support/gl.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "viewer/buffer_view.h"
#include "viewer/camera_control.h"
#include "viewer/model.h"
#include "viewer/volume_overlay.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using viewer::Model;

constexpr glm::ivec2 small{48, 32};

class ViewerModel : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    setenv("LOOM_SHADER_PATH", (dir() / "shaders").c_str(), 1);
    setenv("XDG_STATE_HOME", (dir() / "state").c_str(), 1);
    fs::create_directories(dir() / "shaders");
  }
  static viewer::Options options(const std::string& pipeline = "rsm") {
    return {.pipeline = pipeline, .set = {{"rsm", "size", "32"}}, .size = small};
  }
  static std::vector<glm::vec4> picture(Model& model) {
    while (model.frame_due()) model.frame(0);
    return model.live().renderer().read("image").texels;
  }
  static double difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    if (a.size() != b.size()) return 1e9;
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      largest = std::max<double>(largest, glm::length(glm::vec3(a[i]) - glm::vec3(b[i])));
    return largest;
  }
  /// A copy of a shipped shader that is found first.
  std::string own_shader(const std::string& name) const {
    const fs::path to = dir() / ("shaders/" + name);
    fs::create_directories(to.parent_path());
    fs::copy_file(LOOM_SOURCE_DIR "/shaders/" + name, to, fs::copy_options::overwrite_existing);
    return to.string();
  }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::string& file, const std::string& text) { std::ofstream(file, std::ios::trunc) << text; }
  /// Writes, and makes sure that the time of the file is another one.
  static void save(const std::string& file, const std::string& text) {
    const auto before = fs::last_write_time(file);
    write(file, text);
    fs::last_write_time(file, before + std::chrono::seconds(2));
  }
};

TEST_F(ViewerModel, RestsWhenNothingChangesAndShowsAnEditAtOnce) {
  Model model(options());
  const auto first = picture(model);
  EXPECT_FALSE(model.frame_due());
  const auto frames = model.frames();
  ASSERT_TRUE(model.set_param("tonemap", "exposure", "1"));
  EXPECT_TRUE(model.is_changed("tonemap", "exposure"));
  EXPECT_GT(difference(picture(model), first), .05);
  EXPECT_EQ(model.frames(), frames + 1);
  model.undo();
  EXPECT_EQ(difference(picture(model), first), 0);
  EXPECT_FALSE(model.is_changed("tonemap", "exposure"));
  model.redo();
  EXPECT_TRUE(model.is_changed("tonemap", "exposure"));
  ASSERT_TRUE(model.reset_param("tonemap", "exposure"));
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, EditsOfOneGestureUndoAsOne) {
  Model model(options());
  const auto first = picture(model);
  for (const char* value : {"1", "2", "3"}) model.set_param("tonemap", "exposure", value, "drag");
  model.end_gesture();
  model.set_param("tonemap", "exposure", "4", "drag");
  model.undo();
  EXPECT_EQ(model.settings().at("tonemap.exposure"), "3");
  model.undo();
  EXPECT_FALSE(model.can_undo());
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, WhatIsRefusedChangesNothing) {
  Model model(options());
  const auto first = picture(model);
  for (const char* bad : {"1e9", "nan", "\"x\"", "", "[1,2]", "{"}) {
    EXPECT_FALSE(model.set_param("tonemap", "exposure", bad)) << bad;
    EXPECT_TRUE(model.problem().has_errors()) << bad;
  }
  EXPECT_FALSE(model.set_param("nobody", "nothing", "1"));
  EXPECT_FALSE(model.open_pipeline("/nowhere/x.json"));
  EXPECT_FALSE(model.open_scene("/nowhere/x.gltf"));
  EXPECT_FALSE(model.can_undo());
  model.touch();
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, SwitchingKeepsCameraAndScene) {
  Model model(options());
  scene::Camera camera = model.camera();
  viewer::aim_at_scene(camera, model.box());
  viewer::orbit(camera, {.2, .1});
  model.set_camera(camera);
  const auto first = picture(model);
  for (const std::string& path : model.pipelines()) {
    if (path.find("direct.json") == std::string::npos && path.find("/lpv.json") == std::string::npos) continue;
    ASSERT_TRUE(model.open_pipeline(path)) << path;
    EXPECT_GT(difference(picture(model), first), .005) << path;
    EXPECT_EQ(model.camera().eye, camera.eye);
  }
  model.undo();
  model.undo();
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, SurvivesAnySize) {
  Model model(options());
  const auto first = picture(model);
  ASSERT_TRUE(model.resize({1, 1}));
  EXPECT_EQ(picture(model).size(), 1u);
  ASSERT_TRUE(model.resize({-3, 0}));
  ASSERT_TRUE(model.resize(small));
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, ABrokenShaderKeepsTheLastPictureUntilItIsMended) {
  const std::string shader = own_shader("tonemap/tonemap.comp");
  const std::string good = text_of(shader);
  Model model(options());
  const auto first = picture(model);
  save(shader, good + "\nthis is no GLSL\n");
  ASSERT_TRUE(model.poll_files());
  ASSERT_TRUE(model.problem().has_errors());
  EXPECT_THAT(to_string(model.problem().all().front()), HasSubstr("tonemap.comp:"));
  EXPECT_FALSE(model.frame_due());
  EXPECT_EQ(difference(model.live().renderer().read("image").texels, first), 0);
  EXPECT_FALSE(model.set_param("tonemap", "exposure", "1")) << "it cannot run yet, and says so";
  EXPECT_FALSE(model.poll_files()) << "nothing new was saved";
  const std::size_t end = good.rfind('}');
  save(shader,
       good.substr(0, end) + "  imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(0, 1, 0, 1));\n}\n");
  ASSERT_TRUE(model.poll_files());
  EXPECT_FALSE(model.problem().has_errors());
  EXPECT_EQ(picture(model).front(), glm::vec4(0, 1, 0, 1));
  save(shader, good);
  ASSERT_TRUE(model.poll_files());
}

TEST_F(ViewerModel, ABrokenPipelineFileKeepsTheLastPicture) {
  const std::string file =
      dir().write("mine.json", R"({"extends": ")" LOOM_SOURCE_DIR R"(/pipelines/direct.json", "name": "mine"})");
  Model model({.pipeline = file, .size = small});
  const auto first = picture(model);
  save(file, R"({"extends": )");
  ASSERT_TRUE(model.poll_files());
  ASSERT_TRUE(model.problem().has_errors());
  EXPECT_EQ(model.problem().all().front().where.line, 1);
  model.touch();
  EXPECT_EQ(difference(picture(model), first), 0);
  save(file, R"({"extends": ")" LOOM_SOURCE_DIR
             R"(/pipelines/direct.json", "name": "mine", "passes": {"tonemap": {"params": {"exposure": 2}}}})");
  ASSERT_TRUE(model.poll_files());
  EXPECT_FALSE(model.problem().has_errors());
  EXPECT_GT(difference(picture(model), first), .05);
}

TEST_F(ViewerModel, APluginIsSwappedUnderIt) {
  fs::create_directories(dir() / "plugins");
  const std::string plugin = dir() / "plugins/flat.so";
  fs::copy_file(FLAT_DIR "/plugin_flat_1.so", plugin);
  const std::string file = dir().write(
      "flat.json", R"({"name": "flat", "passes": {"flat": {"type": "Flat"}}, "outputs": {"image": "flat.image"}})");
  Model model({.pipeline = file, .size = small, .plugin_dirs = {dir() / "plugins"}});
  EXPECT_FLOAT_EQ(picture(model).front().r, .1F);
  const auto swap = [&](const std::string& bytes) { save(plugin, bytes); };
  swap("no library at all");
  ASSERT_TRUE(model.poll_files());
  ASSERT_TRUE(model.problem().has_errors());
  EXPECT_EQ(model.problem().all().front().code, "plugin-load");
  model.touch();
  EXPECT_FLOAT_EQ(picture(model).front().r, .1F) << "the old code goes on";
  swap(text_of(FLAT_DIR "/plugin_flat_2.so"));
  ASSERT_TRUE(model.poll_files());
  EXPECT_FALSE(model.problem().has_errors());
  EXPECT_FLOAT_EQ(picture(model).front().r, .2F);
}

TEST_F(ViewerModel, StateThatFitsIsKeptOverACompilation) {
  Model model({.pipeline = "rsm-denoised", .set = {{"rsm", "size", "32"}}, .size = small});
  ASSERT_TRUE(model.live().has_state());
  const auto settled = picture(model);
  ASSERT_TRUE(model.inspect("gbuffer.surface.normal"));
  model.frame(0);
  const auto next = model.live().renderer().read("image").texels;
  Model fresh({.pipeline = "rsm-denoised", .set = {{"rsm", "size", "32"}}, .size = small});
  fresh.frame(0);
  const auto first = fresh.live().renderer().read("image").texels;
  EXPECT_LT(difference(next, settled), .25 * difference(first, settled));
}

TEST_F(ViewerModel, LooksAtAnyTextureAndBuffer) {
  Model model(options());
  std::vector<std::string> unmade;
  for (const auto& item : model.inspectables()) {
    if (!item.made) unmade.push_back(item.name);
    ASSERT_TRUE(model.inspect(item.name)) << item.name;
    picture(model);
    ASSERT_EQ(model.inspected_texture() != nullptr, !item.buffer) << item.name;
    ASSERT_EQ(model.inspected_buffer() != nullptr, item.buffer) << item.name;
  }
  EXPECT_THAT(unmade, testing::Not(testing::IsEmpty())) << "somebody reads every member: nothing was tried";
  ASSERT_TRUE(model.open_pipeline(viewer::pipeline_file("gbuffer"))) << "which has other passes";
  EXPECT_FALSE(model.problem().has_errors());
}

TEST_F(ViewerModel, ShowsVirtualLightsAsATable) {
  Model model({.pipeline = "instant-radiosity", .set = {{"vpls", "paths", "64"}}, .size = small});
  ASSERT_TRUE(model.inspect("vpls.vpls.lights"));
  picture(model);
  const Buffer* buffer = model.inspected_buffer();
  ASSERT_NE(buffer, nullptr);
  const viewer::BufferLayout layout = viewer::layout_of("VplSet", "lights");
  const viewer::BufferPage all = viewer::read_page(*buffer, layout, 0, 1000);
  interop::VplHeader header{};
  buffer->read(std::as_writable_bytes(std::span(&header, 1)));
  ASSERT_GT(header.count.x, 20u);
  EXPECT_EQ(all.rows, header.count.x);
  EXPECT_EQ(all.count(), all.rows);
  EXPECT_EQ(all.not_finite, 0u);
  const viewer::BufferPage later = viewer::read_page(*buffer, layout, 10, 5);
  ASSERT_EQ(later.count(), 5u);
  EXPECT_EQ(later.rows, all.rows);
  for (std::size_t column = 0; column < layout.columns.size(); ++column)
    EXPECT_EQ(viewer::cell_of(later, 2, column).text, viewer::cell_of(all, 12, column).text);
  std::vector<interop::Vpl> lights(1);
  buffer->read(std::as_writable_bytes(std::span(lights)), sizeof(interop::VplHeader) + 12 * sizeof(interop::Vpl));
  EXPECT_EQ(viewer::cell_of(all, 12, 1).text, std::to_string(static_cast<int>(lights[0].position.w))) << "the order";
  EXPECT_EQ(viewer::read_page(*buffer, layout, 100000, 5).count(), 0u);
}

TEST_F(ViewerModel, FlagsWhatIsNotFiniteInABuffer) {
  const std::vector<float> values = {1, 2, 3, 4, 5, std::nanf(""), 7, INFINITY, 9};
  const Buffer buffer = Buffer::of(std::span(values), "test");
  const viewer::BufferPage page = viewer::read_page(buffer, viewer::layout_of("Plugins", "own"), 0, 100);
  EXPECT_EQ(page.rows, 2u) << "the ninth number is no row";
  EXPECT_EQ(page.not_finite, 2u);
  EXPECT_FALSE(viewer::cell_of(page, 1, 1).finite);
  EXPECT_EQ(viewer::cell_of(page, 1, 2).text, "7");
  const viewer::BufferPage whole = viewer::read_page(buffer, viewer::layout_of("Plugins", "own", true), 0, 100);
  EXPECT_EQ(viewer::cell_of(whole, 0, 0).text, "1065353216");
  EXPECT_EQ(whole.not_finite, 0u);
}

TEST_F(ViewerModel, ATextureIsOldOnlyWhereItsPassRan) {
  Model model(options());
  ASSERT_TRUE(model.inspect("gbuffer.surface.normal"));
  picture(model);
  const auto version = model.inspected_version();
  model.set_param("tonemap", "exposure", "1");
  picture(model);
  EXPECT_EQ(model.inspected_version(), version) << "the G-buffer is what it was";
  scene::Camera camera = model.camera();
  viewer::aim_at_scene(camera, model.box());
  viewer::orbit(camera, {.2, 0});
  model.set_camera(camera);
  picture(model);
  EXPECT_NE(model.inspected_version(), version);
}

TEST_F(ViewerModel, KnowsWhatIsNeverNegative) {
  Model model({.pipeline = "lpv", .set = {{"rsm", "size", "32"}}, .size = small});
  for (const auto& item : model.inspectables()) {
    EXPECT_TRUE(item.never_negative || (item.name != "gbuffer.surface.depth" && item.name != "rsm.lights.flux"));
    EXPECT_TRUE(!item.never_negative || (item.name != "gbuffer.surface.normal" && item.name != "lpv.intensity.red"));
  }
  ASSERT_TRUE(model.open_pipeline(viewer::pipeline_file("rsm-denoised")));
  bool any = false;
  for (const auto& item : model.inspectables())
    if (item.name.ends_with("irradiance@prev")) {
      any = true;
      EXPECT_TRUE(item.state && item.never_negative);
      EXPECT_EQ(item.unit, "W/m²");
    }
  EXPECT_TRUE(any);
}

/// Small enough to be quick.
viewer::Options volume_options(const std::string& pipeline) {
  viewer::Options options{.pipeline = pipeline, .set = {}, .size = small};
  if (pipeline == "lpv") options.set = {{"rsm", "size", "32"}, {"inject", "grid", "8"}};
  if (pipeline == "radiance-field")
    options.set = {{"rsm", "size", "32"}, {"field", "probes", "3"}, {"field", "bounces", "1"}};
  if (pipeline == "ray-march") options.set = {{"rsm", "size", "32"}, {"voxelize", "grid", "8"}, {"march", "rays", "1"}};
  return options;
}

TEST_F(ViewerModel, EveryVolumeKnowsItsPlace) {
  for (const char* pipeline : {"lpv", "ray-march", "radiance-field"}) {
    Model model(volume_options(pipeline));
    int volumes = 0;
    for (const auto& item : model.inspectables()) {
      if (!item.port.starts_with("intensity") && !item.port.starts_with("voxels") && !item.port.starts_with("field"))
        continue;
      ASSERT_TRUE(model.inspect(item.name)) << item.name;
      model.frame(0);
      ASSERT_TRUE(model.inspects_volume()) << item.name;
      const auto source = model.inspected_volume();
      ASSERT_TRUE(source) << item.name;
      for (int part = 0; part < viewer::part_count(*source); ++part) {
        const viewer::CellMesh mesh = viewer::make_cells(*source, {.part = part}, {});
        volumes += mesh.bodies.empty() ? 0 : 1;
        const float reach = .6F * static_cast<float>(model.box().diagonal());
        for (const auto& body : mesh.bodies)
          ASSERT_LT(glm::distance(body.centre, glm::vec3(model.box().centre())), reach) << item.name;
      }
    }
    EXPECT_GE(volumes, 3) << pipeline;
  }
}

TEST_F(ViewerModel, CellsAreDrawnAndHiddenBySurfaces) {
  Model model(volume_options("lpv"));
  ASSERT_TRUE(model.inspect("lpv.intensity.red"));
  picture(model);
  viewer::VolumeOverlay overlay;
  constexpr glm::ivec2 size{64, 64};
  const auto drawn = [&](const viewer::VolumeSettings& settings) {
    overlay.update(model, settings, {}, size);
    int pixels = 0;
    if (overlay.picture() != nullptr)
      for (const glm::vec4& texel : overlay.picture()->read()) pixels += texel.a > 0 ? 1 : 0;
    return pixels;
  };
  EXPECT_EQ(drawn({.on = false}), 0);
  const int all = drawn({.on = true, .size = .5F});
  EXPECT_GT(all, 100);
  EXPECT_GT(drawn({.on = true, .size = 1}), all);
  EXPECT_THAT(overlay.text_at(model, {2, 2}), testing::IsEmpty());
  // A slice in the middle of the box: seen through its open side, hidden by the wall at its back.
  const auto middle = [&] {
    overlay.update(model, {.on = true, .size = .5F, .one_slice = true}, {.slice = 4, .axis = 2}, size);
    int pixels = 0;
    for (const glm::vec4& texel : overlay.picture()->read()) pixels += texel.a > 0 ? 1 : 0;
    return pixels;
  };
  EXPECT_GT(middle(), 20);
  scene::Camera camera = model.camera();
  camera.target = model.box().centre();
  camera.eye.z = 2 * camera.target.z - camera.eye.z;
  model.set_camera(camera);
  picture(model);
  EXPECT_EQ(middle(), 0);
}

TEST_F(ViewerModel, AbsurdInputIsRefused) {
  Model model(options());
  const auto first = picture(model);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e30}) {
    scene::Camera camera = model.camera();
    camera.eye.x = bad;
    EXPECT_FALSE(model.set_camera(camera)) << bad;
    scene::Light light = model.setup().scene.lights.at(0);
    light.position.y = bad;
    EXPECT_FALSE(model.set_light(0, light)) << bad;
    light = model.setup().scene.lights.at(0);
    light.intensity.r = static_cast<float>(bad);
    EXPECT_FALSE(model.set_light(0, light)) << bad;
    EXPECT_FALSE(model.set_time(bad)) << bad;
  }
  scene::Camera inside = model.camera();
  inside.target = inside.eye;
  EXPECT_FALSE(model.set_camera(inside));
  EXPECT_FALSE(model.set_light(99, {}));
  for (const char* path : {"", "/", "/dev/null", "/etc/passwd", "x.gltf", "x.glb", "x.json"})
    EXPECT_FALSE(model.open_any(path)) << path;
  for (const char* text : {"", "{", "[]", "{}", "null", R"({"asset":{"version":"2.0"},"meshes":3})",
                           R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[7]}],"nodes":[]})"}) {
    EXPECT_FALSE(model.open_any(dir().write("bad.gltf", text))) << text;
    EXPECT_NE(model.open_any(dir().write("bad.json", text)), std::string(text) != "{}") << text;
  }
  EXPECT_FALSE(model.save_picture("/nowhere/x.png"));
  EXPECT_FALSE(model.save_picture("x.txt"));
  EXPECT_FALSE(model.save_pipeline("/nowhere/x.json"));
  EXPECT_FALSE(model.can_undo());
  model.touch();
  EXPECT_EQ(difference(picture(model), first), 0);
}

TEST_F(ViewerModel, SavesOnlyWhatDiffers) {
  Model model(options());
  model.set_param("tonemap", "curve", "\"linear\"");
  model.set_param("tonemap", "exposure", "1.5");
  const auto edited = picture(model);
  const std::string file = dir() / "mine.json";
  ASSERT_TRUE(model.save_pipeline(file)) << model.problem().all().front().message;
  const auto json = nlohmann::json::parse(text_of(file));
  EXPECT_EQ(json["passes"]["tonemap"]["params"], (nlohmann::json{{"curve", "linear"}, {"exposure", 1.5}}));
  EXPECT_EQ(json["passes"].size(), 2u) << "rsm.size was given when it was opened";
  Model again({.pipeline = file, .size = small});
  EXPECT_EQ(difference(picture(again), edited), 0);
  EXPECT_TRUE(again.settings().empty());
  EXPECT_FALSE(again.save_pipeline(file)) << "a file cannot extend itself";
}

TEST_F(ViewerModel, TheCommandLineRendersTheSameView) {
  Model model(options());
  scene::Camera camera = model.camera();
  viewer::aim_at_scene(camera, model.box());
  viewer::orbit(camera, {.3, .1});
  model.set_camera(camera);
  model.set_param("tonemap", "exposure", "-.75");
  scene::Light light = model.setup().scene.lights.at(0);
  light.position += glm::dvec3(.1, 0, .05);
  light.intensity *= .5F;
  for (const bool moved : {false, true}) {
    if (moved) model.set_light(0, light);
    picture(model);
    const std::string here = dir() / "here.png", there = dir() / "there.png";
    ASSERT_TRUE(model.save_picture(here));
    std::string command = model.command_line();
    ASSERT_THAT(command, HasSubstr("loom render "));
    command.replace(command.rfind("view.png"), 8, there);
    const ProcessResult result = run_process("/bin/sh", {"-c", LOOM_BINARY_DIR "/bin/" + command});
    ASSERT_EQ(result.exit_code, 0) << command << "\n" << result.err;
    const ImageLayers a = read_png(here), b = read_png(there);
    ASSERT_EQ(a.channels.at("R").size(), b.channels.at("R").size());
    for (const char* channel : {"R", "G", "B"})
      for (std::size_t i = 0; i < a.channels.at(channel).size(); ++i)
        ASSERT_NEAR(a.channels.at(channel)[i], b.channels.at(channel)[i], 1e-2) << command;
  }
}

TEST_F(ViewerModel, AMovedLightIsSeenAndUndone) {
  Model model(options());
  const auto first = picture(model);
  scene::Light light = model.setup().scene.lights.at(0);
  light.intensity = glm::vec3(3, .1F, .1F);
  model.set_light(0, light);
  EXPECT_GT(difference(picture(model), first), .05);
  EXPECT_FALSE(model.problem().has_errors());
  model.undo();
  EXPECT_EQ(difference(picture(model), first), 0);
}

}  // namespace
}  // namespace loom::test
