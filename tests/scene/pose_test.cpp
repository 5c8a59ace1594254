// Animation, skins, and what moves with the nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include <glm/geometric.hpp>

#include "files.h"
#include "gltf_builder.h"
#include "scene/bounds.h"
#include "scene/load.h"
#include "support/temp_dir.h"

namespace {

using loom::Diagnostics;
using loom::SceneFacts;
using loom::scene::pose;
using loom::scene::Scene;
using loom::test::GltfBuilder;
using loom::test::Json;

Scene load(const GltfBuilder& builder) {
  const loom::test::TempDir temp;
  Diagnostics diagnostics;
  return loom::scene::load_gltf(temp.write("test.gltf", builder.text()), diagnostics);
}

void animate(GltfBuilder& builder, int node, const std::string& path, const std::string& interpolation,
             const std::string& type, int components, const std::vector<float>& times,
             const std::vector<float>& values) {
  const int input = builder.accessor<float>("SCALAR", 1, times);
  const int output = builder.accessor<float>(type, components, values);
  builder.json["animations"] = Json::array(
      {{{"samplers", Json::array({{{"input", input}, {"output", output}, {"interpolation", interpolation}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}})}}});
}

double x_at(Scene& scene, double time) {
  pose(scene, time);
  return scene.instances.at(0).world[3].x;
}

TEST(Pose, LinearAndStepHoldTheirEnds) {
  GltfBuilder linear;
  animate(linear.triangle(), 0, "translation", "LINEAR", "VEC3", 3, {1, 2}, {0, 0, 0, 10, 0, 0});
  Scene scene = load(linear);
  EXPECT_EQ(x_at(scene, 0), 0);
  EXPECT_DOUBLE_EQ(x_at(scene, 1.25), 2.5);
  EXPECT_EQ(x_at(scene, 9), 10);
  GltfBuilder step;
  animate(step.triangle(), 0, "translation", "STEP", "VEC3", 3, {1, 2}, {3, 0, 0, 10, 0, 0});
  scene = load(step);
  EXPECT_EQ(x_at(scene, 1.99), 3);
  EXPECT_EQ(x_at(scene, 2), 10);
}

TEST(Pose, CubicIsTheHermiteSpline) {
  GltfBuilder builder;
  // Keys are (in-tangent, value, out-tangent); x(t) = t³ on [0, 2]: values 0 and 8, slopes 0 and 12.
  animate(builder.triangle(), 0, "translation", "CUBICSPLINE", "VEC3", 3, {0, 2},
          {0, 0, 0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 0, 0, 0});
  Scene scene = load(builder);
  for (const double t : {.25, .5, 1.0, 1.75}) EXPECT_NEAR(x_at(scene, t), t * t * t, 1e-12);
}

TEST(Pose, RotationsAreInterpolatedOnTheSphere) {
  GltfBuilder builder;
  const float half = std::sqrt(.5f);
  animate(builder.triangle(), 0, "rotation", "LINEAR", "VEC4", 4, {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
  Scene scene = load(builder);
  pose(scene, 1.0 / 3);
  const glm::dvec3 x(scene.instances.at(0).world[0]);
  EXPECT_NEAR(std::atan2(x.y, x.x), 3.14159265358979 / 6, 1e-7);
}

TEST(Pose, SaysWhetherAnythingMoved) {
  GltfBuilder builder;
  animate(builder.triangle(), 0, "translation", "LINEAR", "VEC3", 3, {0, 1}, {0, 0, 0, 1, 0, 0});
  Scene scene = load(builder);
  EXPECT_FALSE(pose(scene, 0));
  EXPECT_TRUE(pose(scene, .5));
  EXPECT_FALSE(pose(scene, .5));
  EXPECT_TRUE(compute_facts(scene).moves);
  GltfBuilder still;
  Scene other = load(still.triangle());
  EXPECT_FALSE(pose(other, 1));
  EXPECT_FALSE(compute_facts(other).moves);
}

TEST(Pose, LightsAndCamerasMoveWithTheirNodes) {
  GltfBuilder builder;
  builder.triangle().json["nodes"] = Json::parse(R"([
    {"mesh": 0, "children": [1]},
    {"camera": 0, "rotation": [0, 1, 0, 0], "children": [2]},
    {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 0, 5]}])");
  builder.json["cameras"] = Json::parse(R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}])");
  builder.json["extensions"] = Json::parse(
      R"({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}, "intensity": 7, "color": [1, 0, 0]}]}})");
  animate(builder, 0, "translation", "LINEAR", "VEC3", 3, {0, 1}, {0, 0, 0, 0, 3, 0});
  Scene scene = load(builder);
  pose(scene, 1);
  // The camera is turned about y: it looks along +z, and what hangs 5 behind it is at z = −5.
  EXPECT_EQ(scene.cameras.at(0).eye, glm::dvec3(0, 3, 0));
  EXPECT_NEAR(glm::length(scene.cameras.at(0).target - glm::dvec3(0, 3, 1)), 0, 1e-12);
  EXPECT_NEAR(glm::length(scene.lights.at(0).position - glm::dvec3(0, 3, -5)), 0, 1e-12);
  EXPECT_NEAR(glm::length(scene.lights.at(0).direction - glm::dvec3(0, 0, 1)), 0, 1e-12);
  EXPECT_EQ(scene.lights.at(0).intensity, glm::vec3(7, 0, 0));
}

/// A triangle that two joints share: the first stays, the second is animated.
GltfBuilder skinned() {
  GltfBuilder builder;
  builder.triangle().json["nodes"] = Json::parse(R"([
    {"mesh": 0, "skin": 0, "translation": [100, 100, 100]}, {"name": "still"}, {"name": "moving", "translation": [0, 1, 0]}])");
  builder.json["scenes"][0]["nodes"] = {0, 1, 2};
  Json& attributes = builder.primitive()["attributes"];
  attributes["JOINTS_0"] = builder.accessor<std::uint8_t>("VEC4", 4, {0, 9, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  // Not normalised, as old files have it: half and half for the last vertex.
  attributes["WEIGHTS_0"] = builder.accessor<float>("VEC4", 4, {1, 0, 0, 0, 2, 0, 0, 0, .7f, .7f, 0, 0});
  const std::vector<float> matrices{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  builder.json["skins"] =
      Json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", builder.accessor<float>("MAT4", 16, matrices)}}});
  animate(builder, 2, "translation", "LINEAR", "VEC3", 3, {0, 1}, {0, 1, 0, 0, 1, 4});
  return builder;
}

glm::dvec3 world_position(const Scene& scene, std::size_t vertex) {
  const loom::scene::Instance& instance = scene.instances.at(0);
  const loom::scene::Primitive& p = scene.meshes.at(static_cast<std::size_t>(instance.mesh)).primitives.at(0);
  return glm::dvec3(instance.world * glm::dvec4(glm::dvec3(p.positions.at(p.indices.at(vertex))), 1));
}

TEST(Pose, SkinsFollowTheirJointsAlone) {
  Scene scene = load(skinned());
  const auto expect = [&](std::size_t vertex, const glm::dvec3& position) {
    EXPECT_NEAR(glm::length(world_position(scene, vertex) - position), 0, 1e-6) << vertex;
  };
  expect(0, {0, 0, 0});
  expect(1, {1, 0, 0});
  expect(2, {0, 1, 0});
  EXPECT_TRUE(pose(scene, 1));
  expect(0, {0, 0, 0});
  expect(1, {1, 0, 4});
  expect(2, {0, 1, 2});
  EXPECT_TRUE(pose(scene, 0)) << "posing starts from the rest pose, not from the last one";
  expect(1, {1, 0, 0});
}

TEST(Pose, AJointThatIsNotThereIsRefused) {
  GltfBuilder builder = skinned();
  builder.json["skins"][0]["joints"] = {1};
  EXPECT_THROW((void)load(builder), loom::BadInput);
}

TEST(Pose, ASkinWithoutAnimationStandsInItsBindPose) {
  const std::filesystem::path file = loom::test::scenes_folder() / "gltf-features/CesiumMan/CesiumMan.glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "absent: $LOOM_SCENES/gltf-features/CesiumMan";
  Diagnostics diagnostics;
  Scene scene = loom::scene::load_gltf(file.string(), diagnostics);
  // In bind pose every joint undoes its own inverse bind matrix, so the mesh keeps its size: 1.507 m tall, arms wide.
  for (std::size_t s = 0; s < scene.skins.size(); ++s) {
    for (std::size_t j = 0; j < scene.skins[s].joints.size(); ++j) {
      loom::scene::Node& node = scene.nodes.at(static_cast<std::size_t>(scene.skins[s].joints[j]));
      node.parent = -1;
      node.matrix = glm::inverse(scene.skins[s].inverse_bind[j]);
    }
  }
  scene.animations.clear();
  pose(scene, 0);
  const loom::scene::Box box = scene_box(scene);
  const glm::dvec3 low(-.131, 0, -.569);
  const glm::dvec3 high(.181, 1.507, .569);
  // The file's box is that of its vertices, whose z is the figure's height.
  glm::dvec3 sizes = box.extent();
  glm::dvec3 noted = high - low;
  std::sort(&sizes.x, &sizes.x + 3);
  std::sort(&noted.x, &noted.x + 3);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sizes[axis], noted[axis], 2e-3);
}

TEST(Pose, BoundsHoldTheWholeAnimation) {
  GltfBuilder builder;
  animate(builder.triangle(), 0, "rotation", "LINEAR", "VEC4", 4, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  const SceneFacts turned = compute_facts(load(builder));
  // Half a turn about z: (1, 0) goes by way of (0, 1) to (−1, 0), and (0, 1) on to (0, −1).
  EXPECT_NEAR(glm::length(turned.bounds_min - glm::dvec3(-1, -1, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::length(turned.bounds_max - glm::dvec3(1, 1, 0)), 0, 1e-6);
  EXPECT_EQ(turned.moving_triangles, 1U);
  const SceneFacts skin = compute_facts(load(skinned()));
  EXPECT_NEAR(skin.bounds_max.z, 4, 1e-6);
  EXPECT_EQ(skin.moving_triangles, 1U);
}

// What hangs on a node that moves does, too; a skin of joints that stand still does not, wherever its node goes.
TEST(Pose, ChildrenMoveWithTheirParents) {
  GltfBuilder builder;
  builder.triangle().json["nodes"] = Json::parse(R"([{"children": [1]}, {"mesh": 0}, {"mesh": 0}])");
  builder.json["scenes"][0]["nodes"] = {0, 2};
  animate(builder, 0, "translation", "LINEAR", "VEC3", 3, {0, 1}, {0, 0, 0, 1, 0, 0});
  EXPECT_EQ(compute_facts(load(builder)).moving_triangles, 1U);
  GltfBuilder still = skinned();
  still.json["animations"][0]["channels"][0]["target"]["node"] = 0;
  EXPECT_EQ(compute_facts(load(still)).moving_triangles, 0U);
}

}  // namespace
