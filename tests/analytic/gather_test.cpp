// GatherRSM against the irradiance of evenly lit surfaces in closed form.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "support/bench.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr glm::vec3 albedo{.8f, .4f, .2f};

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" }, "rsm": { "type": "RSM", "params": { "size": 64, "shadow_size": 16 } },
    "bounce": { "type": "GatherRSM", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } } },
  "outputs": { "image": "bounce.irradiance" } })";

using Set = std::vector<graph::Override>;

class Gather : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels bounce(Bench& bench, int size, Set set, const std::string& output = "image") {
    return bench.image(pipeline, output, {.size = {size, size}, .set = std::move(set)});
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// E/(πL) at distance 1 over the corner of a rectangle a×b, parallel to it.
double corner_factor(double a, double b) {
  const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * pi);
}

/// A floor 2×2 m lit evenly from above, and a speck at height h that faces it, far smaller than a texel.
scene::Scene speck_over_floor(float h, glm::vec3 light = glm::vec3(3)) {
  SceneBuilder scene;
  const int grey = scene.material(albedo);
  scene.floor(glm::vec3(0), 1, grey);
  constexpr float s = 1e-3f;
  scene.quad({-s, h, -s}, {s, h, -s}, {s, h, s}, {-s, h, s}, grey);
  return scene.directional({0, -1, 0}, light).build();
}

void look_up(Bench& bench, double h) { bench.look({0, .5 * h, 0}, {0, h, 0}, .5e-3 / h, {0, 0, 1}); }

TEST_F(Gather, FullSumOverALitSquareIsItsFormFactor) {
  for (const float h : {1.f, .5f, .25f}) {
    Bench bench(*device_, speck_over_floor(h));
    look_up(bench, h);
    const Texels e = bounce(bench, 4, {{"bounce", "method", "full"}});
    const double factor = 4 * corner_factor(1 / h, 1 / h);
    // 64² patches of 2/64 m: their sum is a midpoint rule of second order, and the borders of the floor fall between
    // texels (the map is a thousandth wider on each side).
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.mean()[c] / (albedo[c] * 3), factor, .01 * factor) << h;
  }
}

TEST_F(Gather, FullSumConvergesWithTheMap) {
  Bench bench(*device_, speck_over_floor(.25f));
  look_up(bench, .25);
  const double factor = 4 * corner_factor(4, 4);
  const auto error = [&](const char* size) {
    const Texels e = bounce(bench, 4, {{"bounce", "method", "full"}, {"rsm", "size", size}});
    return std::abs(e.mean().x / (albedo.x * 3) / factor - 1);
  };
  EXPECT_LT(error("32"), .02);
  EXPECT_LT(error("256"), .003);
}

TEST_F(Gather, AReceiverNearOneTexelIsBoundedByItsRadiosity) {
  // A millimetre above the middle of a texel, and a tenth of one beside it, so that it casts no shadow on that texel's
  // ray. The map is a thousandth of the diagonal wider than the floor on each side.
  const double c = (1 + 1e-3 * std::sqrt(8.)) / 64;
  SceneBuilder scene;
  const int grey = scene.material(albedo);
  scene.floor(glm::vec3(0), 1, grey).directional({0, -1, 0}, glm::vec3(3));
  const float x = static_cast<float>(c + 1e-4), s = 2e-5f;
  scene.quad({x - s, 1e-3f, x - s}, {x + s, 1e-3f, x - s}, {x + s, 1e-3f, x + s}, {x - s, 1e-3f, x + s}, grey);
  Bench bench(*device_, scene.build());
  bench.look({x, .5e-3, x}, {x, 1e-3, x}, .01, {0, 0, 1});
  const double radiosity = albedo.x * 3;
  const float bounded = bounce(bench, 4, {{"bounce", "method", "full"}}).mean().x;
  EXPECT_LE(bounded, 1.001 * radiosity);
  // cosθ cosθ' = 1/1.02 and the disc's 1/(1 + r²π/A) = .997 on the way to it.
  EXPECT_GT(bounded, .97 * radiosity);
  // A point light of flux Φ would give Φ/(πr²) = ρE·A/(πr²).
  const float point = bounce(bench, 4, {{"bounce", "method", "full"}, {"bounce", "min_distance", "0"}}).mean().x;
  EXPECT_GT(point, 200 * radiosity);
}

/// The corner of two walls that a point light shines into.
scene::Scene corner(float intensity = 5) {
  SceneBuilder scene;
  const int grey = scene.material(albedo);
  scene.floor(glm::vec3(0), 1, grey);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey);
  return scene.point({.3f, 1, .2f}, glm::vec3(intensity)).build();
}

const Set full{{"bounce", "method", "full"}, {"rsm", "size", "32"}};

TEST_F(Gather, ImportanceSamplingConvergesToTheFullSum) {
  Bench bench(*device_, corner());
  bench.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
  const Texels truth = bounce(bench, 24, full);
  const Texels all =
      bounce(bench, 24, {{"rsm", "size", "32"}, {"bounce", "samples", "2048"}, {"bounce", "radius", "2"}});
  EXPECT_NEAR(all.mean().x / truth.mean().x, 1, .01);
  double error = 0;
  for (std::size_t i = 0; i < all.values.size(); ++i) error += std::pow(all.values[i].x - truth.values[i].x, 2);
  EXPECT_LT(std::sqrt(error / static_cast<double>(all.values.size())), .1 * truth.mean().x);
}

TEST_F(Gather, WhatLiesOutsideTheRadiusIsReported) {
  Bench bench(*device_, corner());
  bench.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
  const Texels truth = bounce(bench, 24, full);
  for (const char* radius : {"0.2", "0.6"}) {
    const Set set{{"rsm", "size", "32"}, {"bounce", "samples", "1024"}, {"bounce", "radius", radius}};
    const float near = bounce(bench, 24, set).mean().x;
    const float missed = bounce(bench, 24, set, "bounce.missed.irradiance").mean().x;
    EXPECT_GT(missed, 0);
    EXPECT_NEAR((near + missed) / truth.mean().x, 1, .01) << radius;
  }
}

TEST_F(Gather, ASpotAndADirectionalLightConvergeToo) {
  SceneBuilder scene;
  const int grey = scene.material(albedo);
  scene.floor(glm::vec3(0), 1, grey);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey);
  scene.spot({.3f, 1.5f, .5f}, {0, -1, -.5f}, glm::vec3(5), .3, .8).directional({.2f, -1, -.3f}, glm::vec3(2));
  Bench bench(*device_, scene.build());
  bench.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
  const Texels truth = bounce(bench, 24, full);
  const Texels all =
      bounce(bench, 24, {{"rsm", "size", "32"}, {"bounce", "samples", "2048"}, {"bounce", "radius", "2"}});
  EXPECT_NEAR(all.mean().x / truth.mean().x, 1, .01);
}

TEST_F(Gather, GivenAndClampedAddUpToTheUnbounded) {
  Bench bench(*device_, corner());
  bench.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
  const Texels given = bounce(bench, 24, full), clamped = bounce(bench, 24, full, "bounce.clamped.irradiance");
  Set unbounded = full;
  unbounded.push_back({"bounce", "min_distance", "0"});
  const Texels all = bounce(bench, 24, unbounded);
  EXPECT_GT(clamped.mean().x, 0);
  for (std::size_t i = 0; i < all.values.size(); ++i) {
    ASSERT_NEAR(given.values[i].x + clamped.values[i].x, all.values[i].x, 1e-4 * all.values[i].x);
  }
}

TEST_F(Gather, IsLinearInIntensity) {
  Bench one(*device_, corner(5)), two(*device_, corner(10));
  for (const Set& set : {full, Set{{"rsm", "size", "32"}}}) {
    one.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
    two.look({.2, 1.2, 1.5}, {0, .4, -.5}, .5);
    const Texels a = bounce(one, 16, set), b = bounce(two, 16, set);
    EXPECT_GT(a.mean().x, 0);
    for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_EQ(2 * a.values[i].x, b.values[i].x);
  }
}

TEST_F(Gather, NoLightIsAbsent) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(albedo));
  Bench bench(*device_, scene.build());
  bench.look_down(.5);
  bench.render(pipeline);
  EXPECT_TRUE(bench.absent("image"));
}

}  // namespace
}  // namespace loom::test
