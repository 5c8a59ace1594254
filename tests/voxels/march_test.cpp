// RayMarch and Radiosity against closed forms: furnaces, skies, spheres, plates, and walls that must not leak.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"
#include "support/bench.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

/// All that a pixel receives by rays: after reflections, and straight from emitters and sky where `emitter` is set.
const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "rsm": { "type": "RSM", "params": { "shadow_size": 512 } },
    "voxelize": { "type": "Voxelize", "in": { "lights": "rsm.lights" }, "params": { "grid": 16, "rays": 64 } },
    "radiosity": { "type": "Radiosity", "in": { "voxels": "voxelize.voxels" } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" }, "params": { "rays": 16 } } },
  "outputs": { "image": "march.irradiance" } })";

class MarchTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static glm::dvec3 mean(Bench& bench, std::vector<graph::Override> set, int size = 16) {
    return glm::dvec3(bench.image(pipeline, "image", {.size = {size, size}, .set = std::move(set)}).mean());
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// A closed box, seen from inside.
scene::Scene furnace(glm::vec3 albedo, glm::vec3 emission, glm::vec3 half = {1.01F, .83F, 1.27F}) {
  scene::Scene scene;
  scene.materials = {diffuse(albedo, emission)};
  add_box(scene, -half, half, 0, true);
  finish(scene);
  return scene;
}

// Every ray ends on a wall: E = π·L_e·(1 + ρ + … + ρⁿ) with n orders of reflection, whatever the grid.
TEST_F(MarchTest, FurnaceIsAGeometricSeries) {
  const glm::vec3 albedo{.8F, .5F, .1F}, emission{1, 2, .3F};
  Bench bench(*device_, furnace(albedo, emission));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  for (const char* grid : {"5", "14"}) {
    for (const int bounces : {1, 4}) {
      const glm::dvec3 e = mean(bench, {{"march", "emitter", "true"},
                                        {"voxelize", "grid", grid},
                                        {"voxelize", "rays", "128"},
                                        {"radiosity", "bounces", std::to_string(bounces)}});
      for (int c = 0; c < 3; ++c) {
        double series = 0;
        for (int k = 0; k <= bounces; ++k) series += std::pow(albedo[c], k);
        EXPECT_NEAR(e[c], pi * emission[c] * series, .02 * pi * emission[c] * series) << grid << ' ' << bounces;
      }
    }
  }
}

// What emits is AreaLight's to count: by itself the march brings only what was reflected.
TEST_F(MarchTest, EmissionIsCountedByOneOfTwo) {
  const glm::vec3 albedo(.5F), emission(1);
  Bench bench(*device_, furnace(albedo, emission));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  const double all = mean(bench, {{"march", "emitter", "true"}, {"radiosity", "bounces", "3"}}).x;
  const double bounce = mean(bench, {{"radiosity", "bounces", "3"}}).x;
  EXPECT_NEAR(all - bounce, pi, .01 * pi);
}

// Over many orders the closed box reaches 1/(1−ρ), and no higher: the gain of an order is ρ.
TEST_F(MarchTest, OrdersAddUpToTheFurnaceBound) {
  const float albedo = .7F;
  Bench bench(*device_, furnace(glm::vec3(albedo), glm::vec3(1)));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  const double e = mean(bench, {{"march", "emitter", "true"},
                                {"voxelize", "grid", "8"},
                                {"voxelize", "rays", "256"},
                                {"radiosity", "bounces", "32"}})
                       .x;
  EXPECT_NEAR(e, pi / (1 - albedo), .02 * pi / (1 - albedo));
}

// Light of flux Φ in the middle of a sphere: each order adds ρᵏΦ/(4πR²), the same everywhere.
TEST_F(MarchTest, IntegratingSphere) {
  const float albedo = .6F, radius = 1.3F;
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(albedo))};
  add_sphere(scene, {.1F, 0, -.2F}, radius, 24, 0, true);
  add_point_light(scene, {.1, 0, -.2}, glm::vec3(5));
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.1, .2, -.2}, {1, -.4, .3}, .6);
  for (const int bounces : {1, 4}) {
    double series = 0;
    for (int k = 1; k <= bounces; ++k) series += std::pow(albedo, k);
    const double direct = 4 * pi * 5 / (4 * pi * radius * radius);
    for (const char* grid : {"12", "20"}) {
      const double e = mean(bench, {{"radiosity", "bounces", std::to_string(bounces)}, {"voxelize", "grid", grid}}).x;
      EXPECT_NEAR(e, direct * series, .03 * direct * series) << grid << ' ' << bounces;
    }
  }
}

// Curved surfaces are planes cell by cell: between them little comes through, less the finer the grid.
TEST_F(MarchTest, ASphereIsAlmostClosed) {
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(0))};
  add_sphere(scene, {.1F, 0, -.2F}, 1.3F, 24, 0, true);
  scene.sky = glm::vec3(1);
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.1, .2, -.2}, {1, -.4, .3}, .6);
  for (const auto& [grid, bound] : {std::pair{"8", .05}, {"12", .03}, {"20", .02}, {"32", .01}}) {
    const double e = mean(bench, {{"march", "emitter", "true"}, {"voxelize", "grid", grid}}).x;
    EXPECT_LT(e, bound * pi) << grid;
  }
}

// A uniform sky over a plane: E = πL, and none of it comes from the plane itself, however it slants through the grid.
TEST_F(MarchTest, SkyOverASlantedPlane) {
  for (const float angle : {0.F, .2F, .5F, .77F}) {
    SceneBuilder scene;
    const glm::vec3 u{std::cos(angle), std::sin(angle), 0}, v{0, 0, -1};
    scene.quad(-u - v, u - v, u + v, -u + v, scene.material(glm::vec3(0)));
    scene.sky({1, 2, 3});
    Bench bench(*device_, scene.build());
    const glm::dvec3 n(-std::sin(angle), std::cos(angle), 0);
    bench.look(4. * n, {0, 0, 0}, .15, {0, 0, 1});
    const glm::dvec3 e = mean(bench, {{"march", "emitter", "true"}});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e[c], pi * (c + 1), 1e-5 * pi * (c + 1)) << angle;
  }
}

// A plane tilted by θ over wide black ground sees (1 + cosθ)/2 of the sky.
TEST_F(MarchTest, SkyOverATiltedPlaneAboveBlackGround) {
  const double angle = 1.1;
  SceneBuilder scene;
  const int black = scene.material(glm::vec3(0));
  scene.floor({0, -.4F, 0}, 12, black);
  const glm::vec3 u = .25F * glm::vec3(std::cos(angle), std::sin(angle), 0), v{0, 0, -.25F};
  scene.quad(-u - v, u - v, u + v, -u + v, black);
  scene.sky(glm::vec3(1));
  Bench bench(*device_, scene.build());
  bench.look(glm::dvec3(-std::sin(angle), std::cos(angle), 0), {0, 0, 0}, .1, {0, 0, 1});
  const double e = mean(bench, {{"march", "emitter", "true"}, {"march", "rays", "64"}, {"voxelize", "grid", "64"}}).x;
  EXPECT_NEAR(e, pi * (1 + std::cos(angle)) / 2, .02 * pi);
}

// Two rooms and a wall between them, light in one: what arrives in the other came through the wall.
TEST_F(MarchTest, WallsLeakNothing) {
  constexpr int grid = 18;
  const float s = 4.F / (grid - 2);  // cell size
  for (const float thickness : {.1F, .5F, 1.F, 2.F}) {
    for (const float shift : {0.F, .37F}) {
      SceneBuilder scene;
      const int grey = scene.material(glm::vec3(.7F));
      // An outer shell 4 m long, fronts inwards, and the wall across its middle.
      const auto inward = [&](glm::vec3 l, glm::vec3 h) {
        scene.quad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}, grey);
        scene.quad({h.x, l.y, h.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {h.x, h.y, h.z}, grey);
        scene.quad({l.x, l.y, h.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {l.x, h.y, h.z}, grey);
        scene.quad({h.x, l.y, l.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, grey);
        scene.quad({l.x, h.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}, grey);
        scene.quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {l.x, l.y, l.z}, grey);
      };
      inward({-2, -1, -1}, {2, 1, 1});
      const float x = shift * s;
      scene.box({x, -1, -1}, {x + thickness * s, 1, 1}, grey);
      scene.point({-1, .2F, .1F}, glm::vec3(5));
      Bench bench(*device_, scene.build());
      const std::vector<graph::Override> set{{"voxelize", "grid", std::to_string(grid)}, {"radiosity", "bounces", "4"}};
      bench.look({-.5, .3, 0}, {-2, -.8, .3}, .6);
      const double lit = mean(bench, set).x;
      bench.look({1, .3, 0}, {2, -.8, .3}, .6);
      const double dark = mean(bench, set).x;
      EXPECT_GT(lit, 1);
      // Under a wall thinner than a cell one piece of floor lies in both rooms, and shines into both.
      EXPECT_LT(dark, (thickness < 1 ? .02 : .001) * lit) << "thickness " << thickness << " cells, shift " << shift;
      RecordProperty("leak", std::to_string(dark / lit));
    }
  }
}

SceneBuilder two_lit_boxes(bool first, bool second, float gain = 1) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 2, scene.material({.7F, .5F, .3F}));
  scene.box({-.9F, .01F, -.5F}, {-.2F, 1.1F, .3F}, scene.material({.2F, .8F, .4F}));
  if (first) scene.point({.5F, 1.5F, 1}, gain * glm::vec3(4, 3, 2));
  if (second) scene.directional(glm::normalize(glm::vec3(.3F, -1, -.4F)), gain * glm::vec3(1, 2, 1));
  return scene;
}

Texels look_at_boxes(Device& device, const scene::Scene& scene) {
  Bench bench(device, scene);
  bench.look({1.5, 2, 2.5}, {-.3, .3, 0}, .4);
  return bench.image(pipeline, "image", {.size = {24, 24}});
}

TEST_F(MarchTest, LightsAddUpAndScale) {
  const Texels a = look_at_boxes(*device_, two_lit_boxes(true, false).build());
  const Texels b = look_at_boxes(*device_, two_lit_boxes(false, true).build());
  const Texels both = look_at_boxes(*device_, two_lit_boxes(true, true).build());
  const Texels twice = look_at_boxes(*device_, two_lit_boxes(true, true, 2).build());
  ASSERT_GT(both.mean().x, 1e-3);
  for (std::size_t i = 0; i < both.values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(both.values[i][c], a.values[i][c] + b.values[i][c], 1e-5 * both.mean()[c]);
      EXPECT_NEAR(twice.values[i][c], 2 * both.values[i][c], 1e-6 * both.mean()[c]);
    }
  }
}

// Metres to (binary) kilometres and millimetres, with intensities that keep every irradiance.
TEST_F(MarchTest, UnitsDoNotMatter) {
  const Texels metres = look_at_boxes(*device_, two_lit_boxes(true, true).build());
  for (const float k : {0x1p-10F, 0x1p10F}) {
    scene::Scene scene = two_lit_boxes(true, true).build();
    for (scene::Mesh& mesh : scene.meshes)
      for (scene::Primitive& primitive : mesh.primitives)
        for (glm::vec3& position : primitive.positions) position *= k;
    for (scene::Light& light : scene.lights) {
      light.position *= k;
      if (light.kind != scene::LightKind::directional) light.intensity *= k * k;
    }
    Bench bench(*device_, scene);
    bench.look(static_cast<double>(k) * glm::dvec3(1.5, 2, 2.5), static_cast<double>(k) * glm::dvec3(-.3, .3, 0), .4);
    const Texels scaled = bench.image(pipeline, "image", {.size = {24, 24}});
    double difference = 0, square = 0;
    for (std::size_t i = 0; i < metres.values.size(); ++i) {
      difference += std::pow(scaled.values[i].x - metres.values[i].x, 2);
      square += std::pow(metres.values[i].x, 2);
    }
    EXPECT_LT(std::sqrt(difference / square), 1e-4) << k;
  }
}

// Feedback over frames reaches what many orders in one frame reach, and stays there.
TEST_F(MarchTest, FeedbackConvergesToAllOrders) {
  const float albedo = .7F;
  Bench bench(*device_, furnace(glm::vec3(albedo), glm::vec3(1)));
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  const char* const feedback = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 8, "rays": 256 } },
    "radiosity": { "type": "Radiosity", "in": { "voxels": "voxelize.voxels", "last": "radiosity.light@prev" },
                   "params": { "bounces": 2 } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" }, "params": { "rays": 16, "emitter": true } } },
  "outputs": { "image": "march.irradiance" } })";
  double before = 0;
  for (const int frames : {1, 3, 40, 80}) {
    const double e = bench.image(feedback, "image", {.size = {16, 16}, .frames = frames}).mean().x;
    EXPECT_GT(e, before * .998) << frames;
    EXPECT_LT(e, 1.02 * pi / (1 - albedo)) << frames;
    before = e;
  }
  EXPECT_NEAR(before, pi / (1 - albedo), .02 * pi / (1 - albedo));
}

}  // namespace
}  // namespace loom::test
