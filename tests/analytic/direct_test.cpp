// DirectLight against E = I(ω)⟨n,l⟩/r² and shadows whose edges are known.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "support/bench.h"

namespace loom::test {
namespace {

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" }, "rsm": { "type": "RSM", "params": { "shadow_size": 512 } },
    "direct": { "type": "DirectLight", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } } },
  "outputs": { "image": "direct.irradiance" } })";

class Direct : public GlTest, public ::testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  Texels irradiance(Bench& bench, const std::string& shadow, std::vector<graph::Override> set = {}) const {
    set.push_back({"direct", "shadow", shadow});
    return bench.image(pipeline, "image", {.size = {96, 96}, .set = set});
  }
  /// Every pixel of a floor seen from above, within .5 %.
  void expect_floor(Bench& bench, double half, const std::function<double(glm::dvec3)>& truth) const {
    bench.look_down(half);
    const Texels e = irradiance(bench, GetParam());
    double largest = 0;
    for (int y = 0; y < e.height; ++y) {
      for (int x = 0; x < e.width; ++x) {
        const glm::dvec3 p = bench.position(x, y, 10);
        ASSERT_NEAR(p.y, 0, 1e-5);
        const double expected = truth(p);
        largest = std::max(largest, expected);
        ASSERT_NEAR(e.at(x, y).x, expected, .005 * expected + 1e-9) << p.x << ' ' << p.z;
        ASSERT_FLOAT_EQ(e.at(x, y).y, .5f * e.at(x, y).x);
      }
    }
    EXPECT_GT(largest, 0);
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};
using DirectShadow = Direct;

constexpr glm::vec3 color{1, .5f, .25f};

TEST_P(Direct, Point) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point({.5f, 2, -.3f}, 4.f * color);
  Bench bench(*device_, scene.build());
  expect_floor(bench, 3, [](glm::dvec3 p) {
    const glm::dvec3 d = glm::dvec3(.5, 2, -.3) - p;
    return 4 * d.y / std::pow(glm::length(d), 3);
  });
}

TEST_P(Direct, SpotWithItsSmoothEdge) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(.3, -1, .2));
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).spot({.5f, 2, -.3f}, axis, 4.f * color, .4, .9);
  Bench bench(*device_, scene.build());
  expect_floor(bench, 3, [&](glm::dvec3 p) {
    const glm::dvec3 d = glm::dvec3(.5, 2, -.3) - p;
    const double t = (-glm::dot(d, axis) / glm::length(d) - std::cos(.9)) / (std::cos(.4) - std::cos(.9));
    // At the outer edge the falloff is 0 to second order; a float cosine moves it by 1e-7 of its slope.
    return std::max(0., 4 * std::pow(std::clamp(t, 0., 1.), 2) * d.y / std::pow(glm::length(d), 3));
  });
}

TEST_P(Direct, Directional) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(.3, -1, .2));
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).directional(axis, 4.f * color);
  Bench bench(*device_, scene.build());
  expect_floor(bench, 3, [&](glm::dvec3) { return -4 * axis.y; });
}

TEST_P(Direct, NoAcneAtGrazingAngles) {
  for (const double elevation_deg : {5., 1., .3}) {
    const double e = elevation_deg * 3.14159265358979 / 180;
    const glm::dvec3 axis(.8 * std::cos(e), -std::sin(e), .6 * std::cos(e));
    SceneBuilder scene;
    scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).directional(axis, 4.f * color);
    Bench bench(*device_, scene.build());
    expect_floor(bench, 9, [&](glm::dvec3) { return 4 * std::sin(e); });
  }
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point({0, .05f, 0}, color);
  Bench bench(*device_, scene.build());
  expect_floor(bench, 9, [](glm::dvec3 p) {
    const glm::dvec3 d = glm::dvec3(0, .05f, 0) - p;
    return d.y / std::pow(glm::length(d), 3);
  });
}

INSTANTIATE_TEST_SUITE_P(Shadow, Direct, ::testing::Values("none", "map", "ray"),
                         [](const auto& parameter) { return parameter.param; });

TEST_P(DirectShadow, EdgeOfAShadowIsWhereItMustBe) {
  // A plate |x| ≤ .5 at height 1 under a light at height 2 throws a shadow |x| ≤ 1 on the floor.
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  scene.floor(glm::vec3(0), 10, grey).point({0, 2, 0}, color);
  scene.quad({-.5f, 1, 5}, {.5f, 1, 5}, {.5f, 1, -5}, {-.5f, 1, -5}, grey);
  Bench bench(*device_, scene.build());
  bench.look({0, .5, 4}, {0, 0, 0}, .5);
  bench.render(pipeline, {.size = {96, 96},
                          .set = {{"direct", "shadow", GetParam()}},
                          .requested = {"image", "gbuffer.surface.depth", "gbuffer.surface.geometric_normal"}});
  const Texels e = bench.read("image"), depth = bench.read("gbuffer.surface.depth");
  // A texel of 512 over a quarter turn, at distance 2: 4/512 m across; half of it each way, plus the half-texel bound.
  const double blur = GetParam() == "map" ? 4. / 512 : 1e-4;
  int dark = 0, lit = 0;
  for (int y = 0; y < e.height; ++y) {
    for (int x = 0; x < e.width; ++x) {
      const double r = depth.at(x, y).x;
      if (r <= 0) continue;
      const glm::dvec3 p = bench.position(x, y, r);
      if (std::abs(p.y) > 1e-3 || std::abs(std::abs(p.x) - 1) < blur) continue;
      const bool shadow = std::abs(p.x) < 1;
      ++(shadow ? dark : lit);
      EXPECT_EQ(e.at(x, y).x == 0, shadow) << p.x << ' ' << p.z;
    }
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(lit, 500);
}

INSTANTIATE_TEST_SUITE_P(Shadow, DirectShadow, ::testing::Values("map", "ray"),
                         [](const auto& parameter) { return parameter.param; });

using DirectOnce = Direct;
INSTANTIATE_TEST_SUITE_P(Once, DirectOnce, ::testing::Values("map"),
                         [](const auto& parameter) { return parameter.param; });

scene::Scene room() {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  scene.box({-1, 0, -1}, {1, 2, 1}, grey).box({-.6f, 0, -.5f}, {-.1f, .9f, .1f}, grey);
  scene.box({.2f, .4f, .1f}, {.6f, .8f, .5f}, grey);
  scene.point({.1f, 1.8f, .2f}, color).spot({-.8f, 1.5f, .8f}, {1, -1, -1}, color, .3, .8);
  return scene.build();
}

TEST_P(DirectOnce, MapAgreesWithRayButForTexelsAlongEdges) {
  Bench bench(*device_, room());
  bench.look({0, 1, .95}, {0, .8, -1}, .8);
  const Texels map = irradiance(bench, "map"), ray = irradiance(bench, "ray"), none = irradiance(bench, "none");
  int differ = 0, shadowed = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    if (std::abs(map.values[i].x - ray.values[i].x) > 1e-4 * none.values[i].x) ++differ;
    if (ray.values[i].x < .99f * none.values[i].x) ++shadowed;
  }
  const int pixels = static_cast<int>(map.values.size());
  EXPECT_GT(shadowed, pixels / 20);
  // Edges of two lights' shadows cross some hundred pixels each; a pixel is as wide as a few texels.
  EXPECT_LT(differ, pixels / 50);
}

TEST_P(DirectOnce, FilteredMapAgreesWithRayToo) {
  Bench bench(*device_, room());
  bench.look({0, 1, .95}, {0, .8, -1}, .8);
  const Texels map = irradiance(bench, "map", {{"direct", "pcf", "true"}}), ray = irradiance(bench, "ray");
  EXPECT_NEAR(map.mean().x / ray.mean().x, 1, .01);
}

TEST_P(DirectOnce, IsLinearInIntensity) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5)));
  SceneBuilder twice = scene;
  Bench bench(*device_, scene.point({.5f, 2, -.3f}, color).build());
  Bench bench2(*device_, twice.point({.5f, 2, -.3f}, 2.f * color).build());
  bench.look_down(3);
  bench2.look_down(3);
  const Texels one = irradiance(bench, "map"), two = irradiance(bench2, "map");
  for (std::size_t i = 0; i < one.values.size(); ++i) ASSERT_EQ(2 * one.values[i].x, two.values[i].x);
}

TEST_P(DirectOnce, ALightBehindTheSurfaceDoesNotReachIt) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point({0, -1, 0}, color);
  Bench bench(*device_, scene.build());
  bench.look_down(3);
  for (const char* shadow : {"none", "map", "ray"}) EXPECT_EQ(irradiance(bench, shadow).mean().x, 0) << shadow;
}

TEST_P(DirectOnce, NoLightIsAbsent) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5)));
  Bench bench(*device_, scene.build());
  bench.look_down(3);
  bench.render(pipeline);
  EXPECT_TRUE(bench.absent("image"));
}

}  // namespace
}  // namespace loom::test
