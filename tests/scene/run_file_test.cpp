// Run files, the camera, the headlamp, the built-in scenes and the shipped run files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "core/data_dir.h"
#include "files.h"
#include "gltf_builder.h"
#include "scene/bounds.h"
#include "scene/load.h"
#include "support/temp_dir.h"

namespace {

namespace fs = std::filesystem;
using loom::Diagnostics;
using loom::scene::load_setup;
using loom::scene::SurfaceModel;
using Loaded = loom::scene::Setup;  // gtest keeps the name Setup for itself
using loom::test::GltfBuilder;
using loom::test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

/// Sets an environment variable for one test.
class Environment {
 public:
  Environment(std::string name, const char* value) : name_(std::move(name)) {
    if (const char* old = std::getenv(name_.c_str())) old_ = old;
    set(value);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { set(old_ ? old_->c_str() : nullptr); }

 private:
  void set(const char* value) { value == nullptr ? unsetenv(name_.c_str()) : setenv(name_.c_str(), value, 1); }
  std::string name_;
  std::optional<std::string> old_;
};

class RunFile : public testing::Test {
 protected:
  RunFile() { temp_.write("triangle.gltf", GltfBuilder().triangle().text()); }

  Loaded load(const std::string& text, const std::string& camera = {}) {
    diagnostics_ = Diagnostics();
    return load_setup(temp_.write("run.json", text), camera, diagnostics_);
  }
  std::string refusal(const std::string& text, const std::string& camera = {}) {
    try {
      (void)load(text, camera);
    } catch (const loom::BadInput& error) {
      std::string said;
      for (const loom::Diagnostic& d : error.diagnostics().all()) said += to_string(d) + "\n";
      return said;
    }
    return "accepted";
  }
  TempDir temp_;
  Diagnostics diagnostics_;
};

TEST_F(RunFile, SaysEverything) {
  const Loaded setup = load(R"({ "scene": "triangle.gltf",
    "camera": { "eye": [0,2.7,8], "target": [0,2.7,0], "up": [0,1,0], "yfov_deg": 90 },
    "lights": [ { "type": "spot", "position": [0,5.3,-2.8], "direction": [0,-2,0], "color": [1,0.5,0], "intensity": 60,
                  "inner_deg": 30, "outer_deg": 45, "range": 3 },
                { "type": "directional", "direction": [0,0,-1] }, { "type": "point", "position": [1,2,3], "intensity": 0 } ],
    "sky": { "radiance": [1,2,3] }, "size": [320,200], "pipeline": "lpv.json",
    "set": { "lpv.iterations": 16, "tonemap.curve": "aces", "a.b": [1, 0.5] } })");
  EXPECT_EQ(setup.camera.eye, glm::dvec3(0, 2.7, 8));
  EXPECT_DOUBLE_EQ(setup.camera.yfov_rad, 1.5707963267948966);
  ASSERT_EQ(setup.scene.lights.size(), 3u);
  EXPECT_EQ(setup.scene.lights[0].intensity, glm::vec3(60, 30, 0));
  EXPECT_EQ(setup.scene.lights[0].direction, glm::dvec3(0, -1, 0));
  EXPECT_DOUBLE_EQ(setup.scene.lights[0].inner_rad, .5235987755982988);
  EXPECT_EQ(setup.scene.lights[1].intensity, glm::vec3(1));
  EXPECT_EQ(setup.scene.sky, glm::vec3(1, 2, 3));
  EXPECT_EQ(setup.size, glm::ivec2(320, 200));
  EXPECT_EQ(setup.pipeline, "lpv.json") << "no file beside the run file: the name of a shipped one";
  using Pair = std::pair<std::string, std::string>;
  EXPECT_THAT(setup.set, testing::ElementsAre(Pair("lpv.iterations", "16"), Pair("tonemap.curve", "\"aces\""),
                                              Pair("a.b", "[1,0.5]")));
}

TEST_F(RunFile, PathsAreRelativeToIt) {
  temp_.write("own.json", "{}");
  const Loaded setup = load(R"({"scene": "triangle.gltf", "pipeline": "own.json"})");
  EXPECT_EQ(setup.pipeline, temp_ / "own.json");
  EXPECT_EQ(setup.scene.path, temp_ / "triangle.gltf");
}

TEST_F(RunFile, EveryMistakeIsNamedWithItsPlace) {
  const std::string said = refusal(R"({
  "scene": "triangle.gltf",
  "camra": {},
  "camera": { "eye": [0, 0], "target": [0, 0, 0], "fov": 3 },
  "lights": [ { "type": "spto" }, { "type": "point", "inner_deg": 3 }, { "type": "directional", "intensity": -1, "direction": [0,0,0] } ],
  "sky": { "radiance": [1, 1, "x"] },
  "size": [0, 20],
  "set": { "iterations": 3 }
})");
  EXPECT_THAT(
      said,
      AllOf(HasSubstr(
                "run.json:3:3: error[unknown-key]: a run file has no key \"camra\"\n  hint: did you mean \"camera\"?"),
            HasSubstr("run.json:4:22: error[run-type]: eye must be an array of three numbers"),
            HasSubstr("a camera has no key \"fov\""), HasSubstr("hint: did you mean \"spot\"?")));
  EXPECT_THAT(said,
              AllOf(HasSubstr("a point light has no key \"inner_deg\""), HasSubstr("this light needs a \"position\""),
                    HasSubstr("intensity must be finite and at least 0"), HasSubstr("the direction has no length"),
                    HasSubstr("radiance must be a number"), HasSubstr("size must lie within 1 and 16384"),
                    HasSubstr("write \"pass.parameter\"")));
}

TEST_F(RunFile, BadFiles) {
  EXPECT_THAT(refusal("[]"), HasSubstr("a run file must be an object"));
  EXPECT_THAT(refusal("{\"scene\": }"), HasSubstr("run.json:1:"));
  EXPECT_THAT(refusal(R"({"scene": "absent.gltf"})"), HasSubstr("absent.gltf: error[gltf-file]: does not exist"));
  EXPECT_THAT(refusal(R"({"scene": "${HOME}/x.gltf"})"), HasSubstr("unknown-variable"));
  EXPECT_THAT(refusal(R"({"scene": "triangle.gltf", "camera": {"eye": [0,1,0], "target": [0,0,0]}})"),
              HasSubstr("up points along its view"));
  EXPECT_THAT(refusal(R"({"scene": "triangle.gltf", "camera": {"eye": [0,1,0], "target": [0,1,0]}})"),
              HasSubstr("the same point"));
}

TEST_F(RunFile, TheFolderOfScenesMustBeSet) {
  const std::string text = R"({"scene": "${LOOM_SCENES}/triangle.gltf"})";
  {
    const Environment unset("LOOM_SCENES", nullptr);
    EXPECT_THAT(refusal(text), AllOf(HasSubstr("run.json:1:11: error[scenes-unset]"), HasSubstr("set LOOM_SCENES")));
  }
  const Environment set("LOOM_SCENES", temp_.path().c_str());
  EXPECT_EQ(load(text).scene.instances.size(), 1u);
}

TEST_F(RunFile, CamerasByNameByJsonAndFraming) {
  GltfBuilder builder;
  builder.triangle().json["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 4}}});
  builder.json["scenes"][0]["nodes"] = {0, 1};
  builder.json["cameras"] = loom::test::Json::parse(
      R"([{"name": "front", "type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])");
  temp_.write("seen.gltf", builder.text());
  const std::string run = R"({"scene": "seen.gltf"})";
  EXPECT_EQ(load(run).camera.name, "front") << "the file's first camera is the default";
  EXPECT_EQ(load(run).camera_index, 0);
  EXPECT_EQ(load(R"({"scene": "seen.gltf", "camera": "front"})").camera.eye, glm::dvec3(0, 0, 4));
  EXPECT_THAT(refusal(R"({"scene": "seen.gltf", "camera": "frnt"})"),
              AllOf(HasSubstr("run.json:1:34"), HasSubstr("did you mean \"front\"?")));
  const Loaded own = load(run, R"({"eye": [0,0,9], "target": [0,0,0]})");
  EXPECT_EQ(own.camera.eye, glm::dvec3(0, 0, 9)) << "the command line has the last word";
  EXPECT_EQ(own.camera_index, -1);
  EXPECT_THAT(refusal(run, R"({"eye": [0,0,9]})"), HasSubstr("a camera needs \"target\""));
  EXPECT_THAT(refusal(run, "back"), HasSubstr("no camera \"back\""));
}

TEST_F(RunFile, FramingSeesTheWholeScene) {
  for (const char* size : {"", R"(, "size": [200, 400])"}) {
    const Loaded setup = load(std::string(R"({"scene": "triangle.gltf")") + size + "}");
    const loom::scene::Box box = scene_box(setup.scene);
    const glm::dvec3 forward = glm::normalize(setup.camera.target - setup.camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, setup.camera.up));
    const glm::dvec3 up = glm::cross(right, forward);
    const double aspect = setup.size ? .5 : 1;
    double widest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p =
          glm::mix(box.low, box.high, glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2)) - setup.camera.eye;
      const double depth = glm::dot(p, forward) * std::tan(.5 * setup.camera.yfov_rad);
      widest = std::max({widest, std::abs(glm::dot(p, up)) / depth, std::abs(glm::dot(p, right)) / (depth * aspect)});
    }
    EXPECT_NEAR(widest, .95, 1e-9);
  }
}

TEST_F(RunFile, AHeadlampWhereNothingEmits) {
  const Loaded dark = load(R"({"scene": "triangle.gltf", "camera": {"eye": [0.5, 0.5, 3], "target": [0.5, 0.5, 0]}})");
  ASSERT_EQ(dark.scene.lights.size(), 1u);
  EXPECT_EQ(dark.scene.lights[0].position, dark.camera.eye);
  // E = I/d² = π W/m² at the centre of the box, 3 m away.
  EXPECT_NEAR(dark.scene.lights[0].intensity.x / 9, 3.14159265, 1e-6);
  ASSERT_FALSE(diagnostics_.all().empty());
  EXPECT_EQ(diagnostics_.all().back().code, "headlamp");

  EXPECT_EQ(load(R"({"scene": "triangle.gltf", "sky": {"radiance": [0, 0, 1]}})").scene.lights.size(), 0u);
  const Loaded zero =
      load(R"({"scene": "triangle.gltf", "lights": [{"type": "point", "position": [0,0,0], "intensity": 0}]})");
  EXPECT_EQ(zero.scene.lights.at(0).intensity, glm::vec3(0)) << "a light of intensity 0 is a light";
}

TEST_F(RunFile, SurfacesAreDiffuseUnlessTheyAreAskedToBeMore) {
  EXPECT_EQ(load(R"({"scene": "triangle.gltf"})").scene.surfaces, SurfaceModel::lambert);
  EXPECT_EQ(load(R"({"scene": "triangle.gltf", "surfaces": "ggx"})").scene.surfaces, SurfaceModel::ggx);
  EXPECT_THAT(refusal(R"({"scene": "triangle.gltf", "surfaces": "gxx"})"), HasSubstr("did you mean \"ggx\"?"));
  const Loaded said = load_setup(temp_.write("run.json", R"({"scene": "triangle.gltf", "surfaces": "ggx"})"), "",
                                 diagnostics_, SurfaceModel::lambert);
  EXPECT_EQ(said.scene.surfaces, SurfaceModel::lambert) << "the command line has the last word";
}

TEST_F(RunFile, LightsReplaceTheFilesOwn) {
  GltfBuilder builder;
  builder.triangle().json["nodes"][0]["extensions"] =
      loom::test::Json::parse(R"({"KHR_lights_punctual": {"light": 0}})");
  builder.json["extensions"] = loom::test::Json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point"}]}})");
  temp_.write("lit.gltf", builder.text());
  EXPECT_EQ(load(R"({"scene": "lit.gltf"})").scene.lights.size(), 1u);
  Loaded setup = load(R"({"scene": "lit.gltf", "lights": [{"type": "point", "position": [5, 6, 7]}]})");
  pose(setup.scene, 1);
  ASSERT_EQ(setup.scene.lights.size(), 1u);
  EXPECT_EQ(setup.scene.lights[0].position, glm::dvec3(5, 6, 7)) << "no node moves it";
}

TEST(BuiltIn, IsTheCornellBox) {
  Diagnostics diagnostics;
  const Loaded setup = load_setup("", "", diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  const loom::SceneFacts facts = compute_facts(setup.scene);
  EXPECT_EQ(facts.triangles, 30u);
  EXPECT_EQ(facts.spot_lights, 1);
  EXPECT_EQ(facts.emissive_triangles, 0);
  EXPECT_NEAR(glm::length(facts.bounds_max - glm::dvec3(5.56, 5.488, 5.592)), 0, 1e-6);
  EXPECT_EQ(setup.camera.name, "published camera");
  EXPECT_NEAR(glm::length(setup.camera.eye - glm::dvec3(2.78, 2.73, -8)), 0, 1e-12);
  EXPECT_NEAR(setup.camera.target.z, -7, 1e-12);
  EXPECT_NEAR(setup.scene.lights.at(0).direction.y, -1, 1e-9);
  // The walls face the room, the blocks face outwards: every front is seen from the light's side or from the camera's.
  const glm::dvec3 room(2.78, 2.744, 2.796);
  for (const loom::scene::Instance& instance : setup.scene.instances) {
    const loom::scene::Mesh& mesh = setup.scene.meshes.at(static_cast<std::size_t>(instance.mesh));
    const loom::scene::Primitive& p = mesh.primitives.at(0);
    const bool block =
        setup.scene.nodes.at(static_cast<std::size_t>(instance.node)).name.find("block") != std::string::npos;
    loom::scene::Box box;
    for (const glm::vec3& position : p.positions) box.add(glm::dvec3(position));
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
      const glm::dvec3 from = block ? box.centre() : room;
      const double facing = glm::dot(glm::dvec3(p.normals[i]), glm::dvec3(p.positions[i]) - from);
      EXPECT_TRUE(block ? facing > 0 : facing < 0) << mesh.name;
    }
  }
}

TEST(BuiltIn, TheEmissiveBoxHasALampThatFacesDown) {
  Diagnostics diagnostics;
  const Loaded setup = load_setup(loom::data_dir() + "/configs/scenes/cornell-box-emissive.gltf", "", diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  EXPECT_TRUE(setup.scene.lights.empty());
  EXPECT_EQ(compute_facts(setup.scene).emissive_triangles, 2);
  for (const glm::vec3& normal : setup.scene.meshes.back().primitives.at(0).normals)
    EXPECT_EQ(normal, glm::vec3(0, -1, 0));
  EXPECT_NEAR(setup.scene.materials.back().emissive.x, 20.621247, 1e-4);
}

std::vector<std::string> shipped_runs() {
  std::vector<std::string> runs;
  for (const fs::directory_entry& entry : fs::directory_iterator(loom::data_dir() + "/configs/runs")) {
    if (entry.path().extension() == ".json") runs.push_back(entry.path().string());
  }
  return runs;
}

class ShippedRun : public testing::TestWithParam<std::string> {};

TEST_P(ShippedRun, Loads) {
  if (loom::test::scenes_folder().empty()) GTEST_SKIP() << "absent: the folder $LOOM_SCENES";
  Diagnostics diagnostics;
  const Loaded setup = load_setup(GetParam(), "", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors());
  for (const loom::Diagnostic& d : diagnostics.all())
    EXPECT_NE(d.code, "headlamp") << "a shipped run file says what lights it";
  EXPECT_TRUE(setup.size.has_value());
  EXPECT_GT(compute_facts(setup.scene).triangles, 0u);
}

std::string name_of(const testing::TestParamInfo<std::string>& info) {
  std::string name = fs::path(info.param).stem().string();
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRun, testing::ValuesIn(shipped_runs()), name_of);

}  // namespace
