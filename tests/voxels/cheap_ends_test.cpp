// What else feeds on the voxels: light propagation by InjectVoxels, and the cheap ends of RayMarch.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "interop/grid.h"
#include "loom/grid.h"
#include "support/bench.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

class CheapEndsTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

const char* const injected = R"({ "passes": {
    "voxelize": { "type": "Voxelize", "params": { "grid": 10 } },
    "inject": { "type": "InjectVoxels", "in": { "voxels": "voxelize.voxels" } } },
  "outputs": { "image": "inject.flux.red" } })";

// A floor of 4 m² under a directional light reflects Φ = ρ·E·A, and that is what the cells above it hold.
TEST_F(CheapEndsTest, InjectionKeepsTheFluxOfTheSurfaces) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material({.5F, .25F, .75F}));
  scene.directional({0, -1, 0}, {3, 2, 1});
  Bench bench(*device_, scene.build());
  bench.render(injected, {.size = {8, 8}, .requested = {"inject.flux.red", "inject.flux.green", "inject.flux.blue"}});
  const double reflected[3] = {.5 * 3 * 4, .25 * 2 * 4, .75 * 1 * 4};
  int channel = 0;
  for (const char* name : {"inject.flux.red", "inject.flux.green", "inject.flux.blue"}) {
    double flux = 0;
    for (const glm::vec4& cell : bench.read(name).values) flux += 2 * std::sqrt(pi) * cell.x;
    EXPECT_NEAR(flux, reflected[channel], 2e-3 * reflected[channel]) << name;
    ++channel;
  }
}

// A closed box: every face between inside and outside is blocked, no other, and the albedo is the walls'.
TEST_F(CheapEndsTest, WallsBlockTheFacesBesideThem) {
  scene::Scene scene;
  scene.materials = {diffuse({.5F, .25F, .75F})};
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, 0, true);
  finish(scene);
  Bench bench(*device_, scene);
  bench.render(injected, {.size = {8, 8},
                          .requested = {"inject.blockers.occupancy", "inject.blockers.albedo", "inject.flux.red"}});
  const Texels occupancy = bench.read("inject.blockers.occupancy");
  const Texels albedo = bench.read("inject.blockers.albedo");
  for (int axis = 0; axis < 3; ++axis) {
    int blocked = 0;
    for (int z = 0; z < 10; ++z)
      for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 10; ++x) {
          const float share = occupancy.at(x, y, z)[axis];
          if (share < 1e-3) continue;
          ++blocked;
          EXPECT_NEAR(share, 1, 1e-3) << axis << " at " << x << " " << y << " " << z;
          const glm::ivec3 at(x, y, z);
          EXPECT_TRUE(at[axis] == 1 || at[axis] == 9);
          EXPECT_NEAR(albedo.at(x, y, z + 10 * axis).y, .25, 1e-3);
        }
    EXPECT_EQ(blocked, 2 * 64);
  }
}

/// A closed box that emits, with radiosity of two orders; `march` fills in the last passes.
std::string furnace_pipeline(const std::string& march) {
  return R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 10, "rays": 128 } },
    "radiosity": { "type": "Radiosity", "in": { "voxels": "voxelize.voxels" }, "params": { "bounces": 2 } },)" +
         march + "}";
}

scene::Scene furnace(float albedo) {
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(albedo), glm::vec3(1))};
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, 0, true);
  finish(scene);
  return scene;
}

// Every direction ends on a wall that reflects ρ·(1 + ρ): E = π·ρ·(1 + ρ) at every pixel. Two bands give a uniform
// field exactly.
TEST_F(CheapEndsTest, VolumeOfProbesInAFurnace) {
  const float albedo = .5F;
  Bench bench(*device_, furnace(albedo));
  bench.look({0, 0, 0}, {-1, .05, .05}, .3);
  for (const bool emitter : {false, true}) {
    const glm::vec4 e =
        bench
            .image(furnace_pipeline(R"(
    "march": { "type": "RayMarch", "in": { "voxels": "voxelize.voxels", "light": "radiosity.light" },
               "params": { "probes": 6, "rays": 256 } },
    "bounce": { "type": "GatherVolume", "in": { "surface": "gbuffer.surface", "volume": "march.volume" } } },
  "outputs": { "image": "bounce.irradiance" })"),
                   "image", {.size = {16, 16}, .set = {{"march", "emitter", emitter ? "true" : "false"}}})
            .mean();
    const double expected = pi * ((emitter ? 1 : 0) + albedo * (1 + albedo));
    EXPECT_NEAR(e.x, expected, .02 * expected) << emitter;
  }
}

// 4096 rays of some 30 crossings each are more rounds than llvmpipe gives one invocation: they take several dispatches,
// whether they leave from probes or from pixels.
TEST_F(CheapEndsTest, AsManyRaysAsTheParameterAllows) {
  Bench bench(*device_, furnace(.5F));
  bench.look({0, 0, 0}, {-1, .05, .05}, .3);
  const auto irradiance = [&](const char* rays) {
    return bench
        .image(furnace_pipeline(R"(
    "march": { "type": "RayMarch", "in": { "voxels": "voxelize.voxels", "light": "radiosity.light" },
               "params": { "probes": 3 } },
    "bounce": { "type": "GatherVolume", "in": { "surface": "gbuffer.surface", "volume": "march.volume" } } },
  "outputs": { "image": "bounce.irradiance" })"),
               "image",
               {.size = {8, 8},
                .set = {{"voxelize", "grid", "48"},
                        {"voxelize", "rays", "4"},
                        {"radiosity", "rays", "4"},
                        {"radiosity", "bounces", "1"},
                        {"march", "rays", rays}}})
        .mean()
        .x;
  };
  const double some = irradiance("512"), all = irradiance("4096");
  EXPECT_NEAR(all, some, .02 * some);
  const auto at_pixels = [&](const char* rays, const char* coarser) {
    return bench
        .image(furnace_pipeline(R"(
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" } } },
  "outputs": { "image": "march.irradiance" })"),
               "image",
               {.size = {6, 6},
                .set = {{"voxelize", "grid", "48"},
                        {"voxelize", "rays", "4"},
                        {"radiosity", "rays", "4"},
                        {"radiosity", "bounces", "1"},
                        {"march", "resolution", coarser},
                        {"march", "rays", rays}}})
        .mean()
        .x;
  };
  const double few = at_pixels("256", "1");
  for (const char* coarser : {"1", "2"}) EXPECT_NEAR(at_pixels("4096", coarser), few, .02 * few) << coarser;
}

// Probes that look up the voxels' light: the same furnace, all orders at once.
TEST_F(CheapEndsTest, ProbesLitByVoxelsInAFurnace) {
  const float albedo = .5F;
  Bench bench(*device_, furnace(albedo));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  const glm::vec4 e = bench
                          .image(furnace_pipeline(R"(
    "field": { "type": "RadianceField", "in": { "voxels": "voxelize.voxels", "light": "radiosity.light" },
               "params": { "probes": 4, "capture": "rays" } },
    "bounce": { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "field.field" } } },
  "outputs": { "image": "bounce.irradiance" })"),
                                 "image", {.size = {16, 16}})
                          .mean();
  EXPECT_NEAR(e.x, pi * albedo * (1 + albedo), .02 * pi * albedo * (1 + albedo));
}

// Nothing stands above an open plane, so that its cones see the whole sky, E = πL: the plane itself is behind them. Two
// posts, far off, make the grid high enough for cones to widen in.
TEST_F(CheapEndsTest, ConesAreNotBlockedByTheSurfaceTheyStartFrom) {
  SceneBuilder scene;
  const int black = scene.material(glm::vec3(0));
  scene.floor(glm::vec3(0), 8, black);
  for (const float x : {-8.f, 7.95f}) scene.box({x, 0, x}, {x + .05f, 8, x + .05f}, black);
  Bench bench(*device_, scene.sky(glm::vec3(1)).build());
  bench.look({0, 2, .5}, {0, 0, 0}, .3);
  const glm::vec4 e = bench
                          .image(R"({ "name": "t", "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 32 } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels" },
               "params": { "method": "cones", "emitter": true } } },
  "outputs": { "image": "march.irradiance" } })",
                                 "image", {.size = {16, 16}})
                          .mean();
  EXPECT_NEAR(e.x, pi, .02 * pi);
}

// Cones never see more than there is, and in a closed box most of it: along its edges coarse cells are partly outside,
// and two walls that fill half of a cell each leave a quarter of a cone through.
TEST_F(CheapEndsTest, ConesInAFurnace) {
  const float albedo = .5F;
  Bench bench(*device_, furnace(albedo));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  const double expected = pi * albedo * (1 + albedo);
  const std::string cone_pipeline = furnace_pipeline(R"(
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" }, "params": { "method": "cones" } } },
  "outputs": { "image": "march.irradiance" })");
  for (const char* cones : {"32", "128"}) {
    const glm::vec4 e =
        bench.image(cone_pipeline, "image", {.size = {16, 16}, .set = {{"march", "cones", cones}}}).mean();
    EXPECT_LT(e.x, 1.02 * expected) << cones;
    EXPECT_GT(e.x, .82 * expected) << cones;
    const BenchOptions with_emission{.size = {16, 16},
                                     .set = {{"march", "cones", cones}, {"march", "emitter", "true"}}};
    const double all = bench.image(cone_pipeline, "image", with_emission).mean().x;
    EXPECT_NEAR(all / e.x, (expected + pi) / expected, .02 * all / e.x) << "emission is met as reflection is";
  }
}

}  // namespace
}  // namespace loom::test
