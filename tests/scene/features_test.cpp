// Every file of the feature collection loads with the triangles, bounds, lights and cameras that its notes list.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <glm/geometric.hpp>

#include "files.h"
#include "scene/load.h"

namespace {

using loom::Diagnostics;
using loom::SceneFacts;
using loom::scene::Scene;

struct Expected {
  const char* file;
  std::size_t triangles;
  glm::dvec3 low, high;
  std::size_t lights, cameras;
};

void PrintTo(const Expected& e, std::ostream* out) { *out << e.file; }

// Figures of the collection's notes; the tolerance below is that of their last printed digit.
const Expected features[] = {
    {"gltf-features/BoxTextured/BoxTextured.gltf", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxTextured-Embedded/BoxTextured.gltf", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxTextured-Binary/BoxTextured.glb", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxTexcoords/boxTexcoords.gltf", 12, {-1, -1, -1}, {1, 1, 1}, 0, 0},
    {"gltf-features/TextureTransformTest/TextureTransformTest.gltf", 24, {-1.6, -1.141, 0}, {1.6, 1.05, .01}, 0, 0},
    {"gltf-features/Cameras/Cameras.gltf", 2, {0, 0, -.708}, {1, .707, 0}, 0, 2},
    {"gltf-features/box_sparse/box_sparse.glb", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/box_sparse/box_sparse.gltf", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxInterleaved/BoxInterleaved.glb", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxVertexColors/BoxVertexColors.glb", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxMeshopt/BoxMeshopt.glb", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/BoxDraco/BoxDraco.gltf", 12, {-.5, -.5, -.5}, {.5, .5, .5}, 0, 0},
    {"gltf-features/KHR_lights_punctual_test/gltf_KHR_lights_punctual_test.glb",
     14,
     {-78.418, -.019, -78.418},
     {78.418, 1.981, 78.418},
     3,
     1},
    {"gltf-features/alpha_mask/01_alpha_mask.gltf", 2, {-1, 0, -1}, {1, 0, 1}, 0, 0},
    {"gltf-features/single_vs_double_sided/01_single_vs_double_sided.gltf",
     1480,
     {-3.5, -.943, -1},
     {1, .943, 1},
     0,
     0},
    {"gltf-features/emission_strength/14_emission_strength.gltf", 17280, {-1, -1, -1}, {35, 1, 1}, 0, 0},
    {"gltf-features/suzanne/02_suzanne.gltf", 3936, {-1.072, -1.614, -1.07}, {1.602, .311, .556}, 0, 0},
    {"gltf-features/gltf_primitives/gltf_primitives.glb", 12, {-1, -1, -1}, {1, 1, 1}, 0, 0},
    {"gltf-features/IrradianceVolumeExample/IrradianceVolumeExample.glb",
     32,
     {-20.2, -.923, -20.2},
     {20.352, 0, 20.503},
     0,
     0},
    {"gltf-features/UtahTeapot/UtahTeapot.glb", 992, {-.161, -.079, -.1}, {.161, .079, .1}, 0, 0},
    {"gltf-features/bunny-encodings/bunny-interleaved.glb",
     30338,
     {-250, -247.564, -193.656},
     {250, 247.564, 193.656},
     0,
     0},
    {"gltf-features/bunny-encodings/bunny-meshopt.glb",
     30338,
     {-250, -247.559, -193.663},
     {250, 247.559, 193.663},
     0,
     0},
    {"gltf-features/bunny-encodings/bunny-quantized.glb",
     30338,
     {-250, -247.559, -193.663},
     {250, 247.559, 193.663},
     0,
     0},
    {"cornell-box/cornell_box.gltf", 32, {0, 0, 0}, {5.56, 5.488, 5.592}, 0, 1},
    {"flight-helmet/FlightHelmet.gltf", 94722, {-.204, 0, -.172}, {.163, .716, .2}, 0, 0},
    {"living-room/living_room.gltf", 28656, {-4.386, -1.975, -.033}, {4.938, 5.182, 9.669}, 0, 0},
    {"mixed-lighting-chair/MixedLightingExample.gltf", 40898, {-1.554, 0, -1.554}, {1.554, .686, 1.554}, 1, 0},
    {"stanford-bunny/StanfordBunny.glb", 30338, {-250, -247.564, -193.656}, {250, 247.564, 193.656}, 0, 0},
    // The notes count the triangles without area too, which are left out: 1134 and 1.
    {"game-map-zdm2/zdm2.glb", 58772 - 1134, {-33.879, -11.968, -29.29}, {43.321, 23.984, 30.31}, 0, 0},
    {"sponza-crytek/sponza.gltf", 262267 - 1, {-15.368, -1.012, -9.462}, {14.399, 11.436, 8.843}, 0, 0},
};

class Features : public testing::TestWithParam<Expected> {};

TEST_P(Features, LoadsAsNoted) {
  const std::string path = (loom::test::scenes_folder() / GetParam().file).string();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "absent: $LOOM_SCENES/" << GetParam().file;
  Diagnostics diagnostics;
  const Scene scene = loom::scene::load_gltf(path, diagnostics);
  const SceneFacts facts = loom::scene::compute_facts(scene);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(facts.triangles, GetParam().triangles);
  EXPECT_EQ(scene.lights.size(), GetParam().lights);
  EXPECT_EQ(scene.cameras.size(), GetParam().cameras);
  constexpr double last_digit = .00051;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(facts.bounds_min[axis], GetParam().low[axis], last_digit) << "axis " << axis;
    EXPECT_NEAR(facts.bounds_max[axis], GetParam().high[axis], last_digit) << "axis " << axis;
  }
  for (const loom::scene::Mesh& mesh : scene.meshes) {
    for (const loom::scene::Primitive& p : mesh.primitives) {
      ASSERT_EQ(p.normals.size(), p.positions.size());
      for (const glm::vec3& normal : p.normals) ASSERT_NEAR(glm::length(normal), 1, 1e-5);
      for (const std::uint32_t index : p.indices) ASSERT_LT(index, p.positions.size());
    }
  }
}

std::string name_of(const testing::TestParamInfo<Expected>& info) {
  std::string name = std::filesystem::path(info.param.file).parent_path().filename().string() + "_" +
                     std::filesystem::path(info.param.file).stem().string();
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name + (std::string(info.param.file).ends_with(".glb") ? "_glb" : "");
}

INSTANTIATE_TEST_SUITE_P(Collection, Features, testing::ValuesIn(features), name_of);

}  // namespace
