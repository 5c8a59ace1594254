// Irradiance at one of n×n pixels, filled along surfaces.
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "near/near_test.h"

namespace loom::test {
namespace {

class Coarse : public NearTest {
 protected:
  /// A far field handed through: ScreenSpaceGI whose rays end nowhere.
  std::string through(const std::string& value) const {
    return R"({ "passes": { )" + source(value) + R"(,
        "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface" } },
        "near": { "type": "ScreenSpaceGI", "in": { "surface": "gbuffer.surface", "radiance": "lit.radiance", "far": "source.e" },
                  "params": { "radius": 0.0001, "slices": 1, "steps": 2 } } },
        "outputs": { "image": "near.irradiance", "truth": "source.e", "depth": "gbuffer.surface.depth" } })";
  }
  static std::vector<graph::Override> by(int n) { return {{"near", "resolution", std::to_string(n)}}; }
};

TEST_F(Coarse, AConstantIsKeptToTheBit) {
  Bench bench(*device_, block());
  bench.look({3, 3, 4}, {0, .3, 0}, .5);
  for (const int n : {2, 3, 4, 8}) {
    for (const glm::ivec2 size : {glm::ivec2(37, 29), glm::ivec2(1, 1), glm::ivec2(8, 3)}) {
      bench.render(through("vec3(.7, .3, 5.)"), {.size = size, .set = by(n)});
      const Texels e = bench.read("image"), depth = bench.read("depth"), truth = bench.read("truth");
      for (std::size_t i = 0; i < e.values.size(); ++i)
        ASSERT_TRUE(depth.values[i].x <= 0 || e.values[i] == truth.values[i]) << n << " " << i;
    }
  }
}

TEST_F(Coarse, EdgesAreNotMixed) {
  // Each surface has a value of its own, in half floats: floor and block lie parallel, and its sides stand square on
  // both.
  Bench bench(*device_, block());
  bench.look({3, 3, 4}, {0, .3, 0}, .35);
  for (const int n : {2, 4}) {
    bench.render(through("vec3(albedo)"), {.size = {61, 47}, .set = by(n)});
    const Texels e = bench.read("image"), truth = bench.read("truth");
    for (std::size_t i = 0; i < e.values.size(); ++i)
      ASSERT_NEAR(e.values[i].x, truth.values[i].x, 0x1p-10) << n << ' ' << i;
  }
}

TEST_F(Coarse, WhatIsLinearOnTheImageStaysSo) {
  Bench bench(*device_, plane());
  bench.look_down(2);
  for (const int n : {2, 4}) {
    const std::string pipeline = through("vec3(1. + float(pixel.x), 100. - float(pixel.y), 1.)");
    bench.render(pipeline, {.size = {40, 40}, .set = by(n)});
    const Texels e = bench.read("image"), truth = bench.read("truth");
    // Beyond the outermost pixels that are computed there is nothing to go by.
    for (int y = n; y < 40 - n; ++y)
      for (int x = n; x < 40 - n; ++x)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(e.at(x, y)[c], truth.at(x, y)[c], 2e-4) << n << ' ' << x << ' ' << y;
  }
}

TEST_F(Coarse, WhatIsThinnerThanABlockIsComputed) {
  // A rod a pixel wide, which most blocks miss.
  SceneBuilder scene;
  const int dark = scene.material(glm::vec3(.25F)), bright = scene.material(glm::vec3(.75F));
  scene.floor(glm::vec3(0), 20, dark).box({0, 1, -3}, {.08F, 1.1F, 3}, bright);
  Bench bench(*device_, scene.build());
  bench.look_down(2);
  bench.render(through("vec3(albedo)"), {.size = {48, 48}, .set = by(4)});
  const Texels e = bench.read("image"), truth = bench.read("truth");
  int rod = 0;
  for (std::size_t i = 0; i < e.values.size(); ++i) {
    ASSERT_NEAR(e.values[i].x, truth.values[i].x, 0x1p-10) << i;
    rod += truth.values[i].x > .5F ? 1 : 0;
  }
  EXPECT_GT(rod, 40);
}

TEST_F(Coarse, EveryPassThatGathersHasIt) {
  // A lit room: at half size a coarser picture of the same light.
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.6F));
  scene.floor(glm::vec3(0), 1, grey).quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey);
  scene.quad({-.3F, 1.9F, -.3F}, {.3F, 1.9F, -.3F}, {.3F, 1.9F, .3F}, {-.3F, 1.9F, .3F},
             scene.material(glm::vec3(0), glm::vec3(4)));
  Bench bench(*device_, scene.point({.3F, 1, .2F}, glm::vec3(5)).build());
  bench.look({.2, 1.2, 2.5}, {0, .6, -.5}, .45);
  const struct {
    const char *pipeline, *pass, *output;
    float tolerance;  // relative, of the mean
  } all[] = {
      {"rsm", "bounce", "bounce.irradiance", .02F},
      {"lpv", "bounce", "bounce.irradiance", .01F},
      {"radiance-field-fast", "bounce", "bounce.irradiance", .01F},
      {"ray-march-fast", "march", "march.irradiance", .05F},
      {"cone-trace-fast", "march", "march.irradiance", .02F},
      {"area", "emitter", "emitter.irradiance", .02F},
      {"screen-space", "bounce", "bounce.irradiance", .03F},
      {"ambient-occlusion", "bounce", "bounce.irradiance", .02F},
  };
  for (const auto& one : all) {
    const auto at = [&](const char* n) {
      return bench.image(
          std::string(one.pipeline) + ".json", one.output,
          {.size = {48, 48}, .set = {{one.pass, "resolution", n}, {"rsm", "size", "32"}}, .requested = {one.output}});
    };
    const Texels full = at("1"), half = at("2");
    EXPECT_NE(half, full) << one.pipeline;
    EXPECT_NEAR(half.mean().x / full.mean().x, 1, one.tolerance) << one.pipeline;
  }
}

}  // namespace
}  // namespace loom::test
