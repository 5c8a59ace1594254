// What rays tell of scenes whose answers are known.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>

#include <gtest/gtest.h>

#include "reference/analysis.h"
#include "scene/load.h"
#include "support/scene_builders.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

const scene::Camera camera = look_at({0, .5, 3}, {0, .5, 0});
constexpr reference::AnalysisOptions coarse{.surface_points = 512, .probes = 2, .face_side = 8};

TEST(Analysis, AnEmptySceneHasNothing) {
  EXPECT_EQ(reference::measure_scene(empty_scene(), camera), SceneMeasurements{});
}

TEST(Analysis, ThicknessOfASlabAndOfASheet) {
  scene::Scene scene = empty_scene();
  add_box(scene, {-1, 0, -1}, {1, .02f, 1}, 0);
  const SceneMeasurements slab = reference::measure_scene(scene, camera, coarse);
  EXPECT_NEAR(slab.thinnest_occluder, .02, 1e-4);
  EXPECT_LT(slab.sheets, .01);
  scene::Scene sheet = empty_scene();
  add_plane(sheet, 1, 0, 0);
  EXPECT_EQ(reference::measure_scene(sheet, camera, coarse).sheets, 1);
}

TEST(Analysis, LightReachesOneRoomOfTwo) {
  scene::Scene scene = empty_scene();
  scene.materials[0] = diffuse(glm::vec3(.5f));
  add_box(scene, {0, 0, 0}, {1, 1, 1}, 0, true);
  add_box(scene, {3, 0, 0}, {6, 2, 2}, 0, true);
  add_point_light(scene, {.5, .5, .5}, glm::vec3(1));
  const SceneMeasurements m = reference::measure_scene(scene, camera, coarse);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(m.lit_min[axis], 0, .02) << axis;
    EXPECT_NEAR(m.lit_max[axis], 1, .02) << axis;
  }
}

/// Inside a sphere that reflects the same everywhere, radiance is a constant.
TEST(Analysis, AConstantIsAllInBandZero) {
  scene::Scene scene = empty_scene();
  scene.materials[0] = diffuse(glm::vec3(.5f));
  add_sphere(scene, glm::vec3(0), 1, 24, 0, true);
  add_point_light(scene, glm::dvec3(0), glm::vec3(1));
  const SceneMeasurements m = reference::measure_scene(scene, camera, coarse);
  EXPECT_GT(m.radiance[0], .98);
  EXPECT_NEAR(std::accumulate(m.radiance.begin(), m.radiance.end(), 0.), 1, .02);
}

TEST(Analysis, TheSameNumbersTwice) {
  scene::Scene scene = empty_scene();
  scene.materials[0] = diffuse(glm::vec3(.5f));
  add_box(scene, {0, 0, 0}, {1, 1, 1}, 0, true);
  add_point_light(scene, {.5, .7, .4}, glm::vec3(1));
  EXPECT_EQ(reference::measure_scene(scene, camera, coarse), reference::measure_scene(scene, camera, coarse));
}

TEST(AnalysisCache, ReturnsWhatItHoldsAndReplacesWhatIsDamaged) {
  const TempDir dir;
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string old = before == nullptr ? "" : before;
  setenv("XDG_CACHE_HOME", dir.path().c_str(), 1);
  SceneMeasurements m;
  m.lit_max = {1, 2, 3};
  m.radiance = {.9, .1};
  m.probes = 7;
  EXPECT_FALSE(reference::cached_measurements(42));
  reference::cache_measurements(42, m);
  EXPECT_EQ(reference::cached_measurements(42), m);
  EXPECT_FALSE(reference::cached_measurements(43));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(dir.path()))
    if (entry.is_regular_file()) std::ofstream(entry.path()) << "{ \"version\": 1, \"lit_min\": [0";
  EXPECT_FALSE(reference::cached_measurements(42)) << "damaged";
  reference::cache_measurements(42, m);
  EXPECT_EQ(reference::cached_measurements(42), m);
  if (before == nullptr) {
    unsetenv("XDG_CACHE_HOME");
  } else {
    setenv("XDG_CACHE_HOME", old.c_str(), 1);
  }
}

}  // namespace
}  // namespace loom::test
