// A scene far from the origin is moved there in double precision, with all that belongs to it.
#include <gtest/gtest.h>

#include <string>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/load.h"
#include "scene/world.h"
#include "support/temp_dir.h"

namespace loom {
namespace {

using Loaded = scene::Setup;

std::string number(double x) { return std::to_string(x); }

/// A triangle of one metre, a light two metres above, a camera three metres before it; all `x` metres to the right.
std::string gltf_at(double x) {
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1,2]}],"extensionsUsed":["KHR_lights_punctual"],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}},
    "cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.01}}],
    "nodes":[{"mesh":0,"translation":[)" +
         number(x) + R"(,0,0]},{"extensions":{"KHR_lights_punctual":{"light":0}},"translation":[)" + number(x) +
         R"(,2,0]},{"camera":0,"name":"lens","translation":[)" + number(x) + R"(,0,3]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

class Recentre : public testing::Test {
 protected:
  Loaded load(const std::string& path) {
    Diagnostics diagnostics;
    return scene::load_setup(path, "", diagnostics);
  }
  test::TempDir temp_;
};

TEST_F(Recentre, KeepsEveryDigitAMillionMetresAway) {
  const Loaded near = load(temp_.write("near.gltf", gltf_at(0)));
  Loaded far = load(temp_.write("far.gltf", gltf_at(1048577.25)));
  EXPECT_EQ(near.scene.origin, glm::dvec3(0));
  EXPECT_GT(far.scene.origin.x, 1e6);
  const glm::dvec3 rest = glm::dvec3(1048577.25, 0, 0) - far.scene.origin;
  EXPECT_LT(glm::length(rest), 2);
  // Exact, though a float at this distance counts in eighths of a metre.
  const auto close = [&](const scene::Scene& scene, const Loaded& other) {
    EXPECT_EQ(world_box(scene).low, world_box(other.scene).low + rest);
    EXPECT_EQ(scene.lights[0].position, other.scene.lights[0].position + rest);
    EXPECT_EQ(scene.cameras[0].eye, other.scene.cameras[0].eye + rest);
  };
  close(far.scene, near);
  EXPECT_EQ(far.camera.eye, near.camera.eye + rest);
  scene::pose(far.scene, 1);  // later frames too
  close(far.scene, near);
}

TEST_F(Recentre, ARunFileSpeaksInTheFilesOwnCoordinates) {
  temp_.write("far.gltf", gltf_at(1e6));
  const Loaded setup = load(temp_.write("run.json", R"({ "scene": "far.gltf",
    "camera": { "eye": [1000000, 0, 3], "target": [1000000, 0, 0] },
    "lights": [ { "type": "point", "position": [1000000, 2, 0] } ] })"));
  const glm::dvec3 place = glm::dvec3(1e6, 0, 0) - setup.scene.origin;
  EXPECT_EQ(setup.camera.eye, place + glm::dvec3(0, 0, 3));
  EXPECT_EQ(setup.camera.target, place);
  EXPECT_EQ(setup.scene.lights[0].position, place + glm::dvec3(0, 2, 0));
  EXPECT_LT(glm::length(place), 2);
}

}  // namespace
}  // namespace loom
