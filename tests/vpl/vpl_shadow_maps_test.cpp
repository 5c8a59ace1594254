// VplShadowMaps and GatherVpls by its maps: against a closed form, and what is traced anew.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <tuple>
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

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "vpls": { "type": "InstantRadiosity", "params": { "paths": 1024, "renew": "never", "bounces": 1, "update": "keep" } },
    "shadows": { "type": "VplShadowMaps", "in": { "vpls": "vpls.vpls" }, "params": { "maps": 2048, "size": 32 } },
    "bounce": { "type": "GatherVpls", "in": { "surface": "gbuffer.surface", "vpls": "vpls.vpls",
                                              "shadows": "shadows.shadows" },
                "params": { "visibility": "shadow-maps", "min_distance": 0 } } },
  "outputs": { "image": "bounce.irradiance", "counts": "vpls.counts", "maps": "shadows.counts" } })";

using Overrides = std::vector<graph::Override>;

class VplShadowMapsTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static double mean(Bench& bench, Overrides set) {
    return bench.image(pipeline, "image", {.size = {4, 4}, .set = std::move(set), .requested = {"image"}}).mean().x;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// A disc of radius `radius` about the origin that faces up (or down), of 64 sides.
void disc(SceneBuilder& scene, float height, float radius, int material) {
  const auto at = [&](int k) {
    const double angle = 2 * pi * k / 64;
    return glm::vec3(radius * std::cos(angle), height, -radius * std::sin(angle));
  };
  for (int i = 0; i < 64; ++i) scene.triangle({0, height, 0}, at(i), at(i + 1), material);
}

// Half way between a disc of exitant radiance L and a point at height h above its middle, a black disc of radius r
// hides all within 2r: E = πL·(R²/(R²+h²) − 4r²/(4r²+h²)). The light comes in so flat that no shadow falls on the disc.
// The maps' texels blur the edge of the shadow to both sides: over all lights that evens out, to 2 %.
TEST_F(VplShadowMapsTest, ALitDiscBehindAnOccluder) {
  const float radius = 1.5F, hidden = .45F, h = 1.5F, rho = .6F;
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(rho)), black = scene.material(glm::vec3(0));
  disc(scene, 0, radius, grey);
  disc(scene, h / 2, hidden, black);
  scene.quad({-.01F, h, -.01F}, {.01F, h, -.01F}, {.01F, h, .01F}, {-.01F, h, .01F}, black);
  scene.directional(glm::normalize(glm::vec3(1, -.2F, 0)), glm::vec3(5));
  Bench bench(*device_, scene.build());
  bench.look({0, h - .1, .001}, {0, h, 0}, .03, {0, 0, 1});
  const auto seen = [&](double r) { return r * r / (r * r + h * h); };
  const double lit = rho * 5 * .2 / std::sqrt(1.04);
  const double open = lit * seen(radius), expected = lit * (seen(radius) - seen(2 * hidden));
  const auto with = [&](const char* how) {
    return mean(bench, {{"vpls", "paths", "2048"}, {"bounce", "visibility", how}});
  };
  EXPECT_NEAR(with("none"), open, .01 * open);
  EXPECT_NEAR(with("rays"), expected, .01 * open);
  EXPECT_NEAR(with("shadow-maps"), expected, .02 * open);
}

// In a hollow ball everything sees everything, and a facet shades neither itself nor its neighbours, at any texel size.
TEST_F(VplShadowMapsTest, NothingShadesItself) {
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(.6F))};
  add_sphere(scene, {.1F, 0, -.2F}, 1.3F, 12, 0, true);
  add_point_light(scene, {.1, 0, -.2}, glm::vec3(5));
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.1, .2, -.2}, {1, -.4, .3}, .6);
  const auto with = [&](const char* how) {
    const Overrides set{{"vpls", "paths", "256"}, {"bounce", "visibility", how}};
    return bench.image(pipeline, "image", {.size = {24, 24}, .set = set, .requested = {"image"}});
  };
  const Texels mapped = with("shadow-maps"), open = with("none");
  for (std::size_t i = 0; i < open.values.size(); ++i) {
    EXPECT_NEAR(mapped.values[i].x, open.values[i].x, 1e-5 * open.values[i].x);
  }
}

SceneBuilder corner() {
  SceneBuilder scene;
  const int grey = scene.material({.7F, .5F, .3F});
  scene.floor(glm::vec3(0), 1, grey);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey);
  scene.box({-.3F, 0, -.5F}, {.1F, .5F, -.2F}, grey);
  return scene;
}

// The budget goes to the brightest: in a closed room of albedo ρ = .5, without roulette, the 256 lights of the first
// reflection have a flux of ρΦ/256 each, and those of the second ρ²Φ/256.
TEST_F(VplShadowMapsTest, TheBrightestComeFirst) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  const SceneBuilder outwards = SceneBuilder().box(glm::vec3(-1), glm::vec3(1), 0);
  for (const scene::Mesh& mesh : outwards.build().meshes) {
    const auto& p = mesh.primitives[0].positions;
    scene.triangle(p[0], p[2], p[1], grey);
  }
  scene.point({.3F, .1F, .2F}, glm::vec3(2));
  Bench bench(*device_, scene.build());
  const auto maps = [&](const char* number) {
    const Overrides set{{"vpls", "paths", "256"},
                        {"vpls", "bounces", "2"},
                        {"vpls", "roulette", "none"},
                        {"shadows", "size", "4"},
                        {"shadows", "maps", number}};
    return bench.image(pipeline, "maps", {.size = {2, 2}, .set = set, .requested = {"maps"}}).at(0, 0);
  };
  const auto share = [](double first, double second) { return (first + .5 * second) / (256 * 1.5); };
  for (const auto& [number, expected] : {std::pair(1, share(1, 0)), std::pair(100, share(100, 0)),
                                         std::pair(256, share(256, 0)), std::pair(300, share(256, 44))}) {
    const glm::vec4 found = maps(std::to_string(number).c_str());
    EXPECT_EQ(found.x, number);
    EXPECT_EQ(found.y, number);
    EXPECT_NEAR(found.z, expected, 1e-3 * expected) << number;
    EXPECT_EQ(found.w, 512);
  }
  EXPECT_EQ(maps("2000").x, 512);
  EXPECT_FLOAT_EQ(maps("2000").z, 1);
}

// Where only the lamp moves, lights that keep their place keep their map; the picture is the one of maps all traced
// anew, to the bit. Where geometry moves, all are.
TEST_F(VplShadowMapsTest, OnlyWhatWasReplacedIsTraced) {
  scene::Scene scene = corner().build();
  add_point_light(scene, {.5, 1, .3}, glm::vec3(3));
  scene.nodes.push_back({.light = 0});
  scene.animations.resize(1);
  scene.animations[0].channels.push_back({.node = static_cast<int>(scene.nodes.size()) - 1,
                                          .times = {0, 1},
                                          .values = {glm::vec4(.5F, 1, .3F, 0), glm::vec4(.52F, 1.01F, .31F, 0)}});
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({0, 1, 1.5}, {0, .1, -.9}, .3);
  const auto moved = [&](std::vector<std::string> disabled) {
    bench.render(pipeline,
                 {.size = {16, 16}, .set = {{"shadows", "size", "8"}}, .disabled_rules = std::move(disabled)});
    EXPECT_EQ(bench.read("maps").at(0, 0).y, bench.read("maps").at(0, 0).x);
    bench.pose(1);
    bench.next_frame();
    const glm::vec4 maps = bench.read("maps").at(0, 0), lights = bench.read("counts").at(0, 0);
    const Texels image = bench.read("image");
    bench.pose(0);
    return std::tuple(maps, lights, image);
  };
  const auto [maps, lights, image] = moved({});
  EXPECT_EQ(maps.x, lights.x);
  EXPECT_GT(lights.y, .5 * lights.x);
  EXPECT_EQ(maps.y, lights.x - lights.y);
  const auto [all, same, again] = moved({"static"});
  EXPECT_EQ(all.y, same.x);
  EXPECT_EQ(image.values, again.values);
}

TEST_F(VplShadowMapsTest, MovingGeometryRenewsAll) {
  SceneBuilder scene = corner();
  scene.point({.5F, 1, .3F}, glm::vec3(3)).moving({.2F, 0, 0}).box({.5F, .2F, -.6F}, {.6F, .3F, -.5F}, 0);
  Bench bench(*device_, scene.build());
  bench.look({0, 1, 1.5}, {0, .1, -.9}, .3);
  bench.render(pipeline, {.size = {4, 4}, .set = {{"shadows", "size", "4"}}});
  bench.pose(1);
  bench.next_frame();
  const glm::vec4 maps = bench.read("maps").at(0, 0);
  EXPECT_EQ(maps.y, maps.x);
  EXPECT_GT(maps.x, 100);
}

}  // namespace
}  // namespace loom::test
