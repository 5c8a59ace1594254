// What emitters and the sky light is injected after its first reflection, once.
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include "support/bench.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" }, "rsm": { "type": "RSM", "params": { "size": 64, "shadow_size": 16 } },
    "inject": { "type": "Inject", "in": { "lights": "rsm.lights", "surface": "gbuffer.surface" },
                "params": { "grid": 8, "emission_rays": 16384 } },
    "lpv": { "type": "LPV", "in": { "flux": "inject.flux", "blockers": "inject.blockers" },
             "params": { "iterations": 64, "bounces": 1 } },
    "bounce": { "type": "GatherVolume", "in": { "surface": "gbuffer.surface", "volume": "lpv.intensity" } },
    "emitter": { "type": "AreaLight", "in": { "surface": "gbuffer.surface" } } },
  "outputs": { "image": "bounce.irradiance", "emitter": "emitter.irradiance" } })";

using Set = std::vector<graph::Override>;

class Emission : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels read(Bench& bench, const std::string& output, Set set = {}) {
    return bench.image(pipeline, output, {.size = {32, 32}, .set = std::move(set)});
  }
  /// ∫ I dω over all cells, W.
  static double flux(Bench& bench, const std::string& channel = "red", const Set& set = {}) {
    double sum = 0;
    for (const glm::vec4& c : read(bench, "inject.flux." + channel, set).values) sum += 2 * std::sqrt(pi) * c.x;
    return sum;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// A closed cube of 2 m, fronts inward, of one material.
scene::Scene furnace(glm::vec3 albedo, glm::vec3 emission) {
  SceneBuilder scene;
  const int wall = scene.material(albedo, emission, true);
  return scene.box(glm::vec3(-1), glm::vec3(1), wall).build();
}

/// A closed cube of 2 m with a lamp of 1 m² under its ceiling, and perhaps a point light.
scene::Scene room(glm::vec3 albedo, glm::vec3 radiance, bool point = false) {
  SceneBuilder scene;
  const int wall = scene.material(albedo), lamp = scene.material(albedo, radiance);
  scene.box(glm::vec3(-1), glm::vec3(1), wall);
  scene.quad({-.5F, .9F, -.5F}, {.5F, .9F, -.5F}, {.5F, .9F, .5F}, {-.5F, .9F, .5F}, lamp);
  if (point) scene.point({.3F, -.2F, .1F}, glm::vec3(2));
  return scene.build();
}

void look(Bench& bench) { bench.look({0, 0, .9}, {0, 0, -1}, .6); }

// Every ray of a closed scene arrives: ρ of the emitted flux Σ π·L·A is injected. Two-sided walls send half of it out,
// where it meets nothing.
TEST_F(Emission, OfAFurnaceIsItsPowerTimesAlbedo) {
  Bench bench(*device_, furnace({.5F, .25F, .8F}, {2, 1, 3}));
  look(bench);
  // The choice of sides alternates: half to either.
  const double inside = pi * 24;
  EXPECT_NEAR(flux(bench, "red"), .5 * 2 * inside, 2e-3 * inside);
  EXPECT_NEAR(flux(bench, "green"), .25 * 1 * inside, 2e-3 * inside);
  EXPECT_NEAR(flux(bench, "blue"), .8 * 3 * inside, 2e-3 * inside);
}

TEST_F(Emission, OfALampIsItsPowerTimesAlbedo) {
  for (const char* rays : {"1024", "16384"}) {
    Bench bench(*device_, room(glm::vec3(.5F), glm::vec3(4)));
    look(bench);
    EXPECT_NEAR(flux(bench, "red", {{"inject", "emission_rays", rays}}), .5 * pi * 4, 1e-3 * pi) << rays;
  }
}

TEST_F(Emission, OfTheSkyOnAPlateIsPiLAOnEachSide) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(.5F)));
  Bench bench(*device_, scene.sky(glm::vec3(3)).build());
  bench.look_down(1);
  EXPECT_NEAR(flux(bench), .5 * pi * 3 * 4 * 2, .01 * 12 * pi);
}

// The unreflected light is AreaLight's alone: where nothing reflects, nothing bounces.
TEST_F(Emission, BlackWallsGiveNoBounce) {
  Bench bench(*device_, room(glm::vec3(0), glm::vec3(4)));
  look(bench);
  bench.render(pipeline, {.size = {16, 16}});
  EXPECT_GT(bench.read("emitter").mean().x, 0);
  EXPECT_EQ(bench.read("image").mean().x, 0);
}

TEST_F(Emission, WithoutRaysOrEmittersThereIsNoBounce) {
  Bench bench(*device_, room(glm::vec3(.5F), glm::vec3(4)));
  look(bench);
  bench.render(pipeline, {.size = {16, 16}, .set = {{"inject", "emission_rays", "0"}}});
  EXPECT_TRUE(bench.absent("image"));
  Bench dark(*device_, room(glm::vec3(.5F), glm::vec3(0)));
  look(dark);
  dark.render(pipeline, {.size = {16, 16}});
  EXPECT_TRUE(dark.absent("image"));
}

TEST_F(Emission, TwiceTheRadianceIsTwiceTheResult) {
  Bench one(*device_, room(glm::vec3(.5F), glm::vec3(4))), two(*device_, room(glm::vec3(.5F), glm::vec3(8)));
  look(one), look(two);
  const Set set{{"lpv", "bounces", "3"}};
  const Texels a = read(one, "image", set), b = read(two, "image", set);
  EXPECT_GT(a.mean().x, 0);
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    for (int c = 0; c < 3; ++c) ASSERT_EQ(2 * a.values[i][c], b.values[i][c]);
  }
}

TEST_F(Emission, AddsToWhatLightsGive) {
  Bench lamp(*device_, room(glm::vec3(.5F), glm::vec3(4)));
  Bench both(*device_, room(glm::vec3(.5F), glm::vec3(4), true));
  Bench point(*device_, room(glm::vec3(.5F), glm::vec3(0), true));
  look(lamp), look(both), look(point);
  const Texels a = read(lamp, "inject.flux.red"), b = read(point, "inject.flux.red");
  const Texels sum = read(both, "inject.flux.red");
  for (std::size_t i = 0; i < sum.values.size(); ++i) {
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(a.values[i][c] + b.values[i][c], sum.values[i][c], 1e-6);
  }
}

// The uniform furnace: E = πL straight, and each further reflection gives ρ of the one before; with all orders
// E = πL/(1−ρ). A light of no account in the middle sees all walls, so that all of them block.
TEST_F(Emission, OrdersOfAFurnaceAreAGeometricSeries) {
  SceneBuilder scene;
  scene.box(glm::vec3(-1), glm::vec3(1), scene.material(glm::vec3(.5F), glm::vec3(1), true));
  Bench bench(*device_, scene.point(glm::vec3(0), glm::vec3(1e-6F)).build());
  bench.look({-.95, -.95, -.95}, {1, 1, 1}, .75);
  const auto mean = [&](const char* output, const char* bounces) {
    bench.render(pipeline, {.size = {64, 64}, .set = {{"lpv", "bounces", bounces}, {"emitter", "closed_form", "16"}}});
    return static_cast<double>(bench.read(output).mean().x);
  };
  EXPECT_NEAR(mean("emitter", "1"), pi, 1e-3 * pi);
  // The grid loses 5 % of the first order near edges and 2 % in each further one; counted twice it would be double.
  double sum = 0, order = pi, before = 0;
  for (const char* bounces : {"1", "2", "3", "4"}) {
    order *= .5;
    const double e = mean("image", bounces) - sum;
    EXPECT_NEAR(e, order, .11 * order) << bounces;
    if (before > 0) {
      EXPECT_NEAR(e / before, .5, .015) << bounces;
    }
    sum += e;
    before = e;
  }
}

// What is traced once stands for later frames, and is traced again for every frame where nothing may be kept.
TEST_F(Emission, IsTheSameInEveryFrame) {
  Bench bench(*device_, room(glm::vec3(.5F), glm::vec3(4)));
  look(bench);
  const Texels first = bench.image(pipeline, "inject.flux.red", {.size = {16, 16}});
  EXPECT_TRUE(bench.image(pipeline, "inject.flux.red", {.size = {16, 16}, .frames = 3}) == first);
  EXPECT_TRUE(bench.image(pipeline, "inject.flux.red", {.size = {16, 16}, .prune = false, .frames = 2}) == first);
  EXPECT_TRUE(bench.image(pipeline, "inject.flux.red", {.size = {16, 16}, .poison = true}) == first);
}

}  // namespace
}  // namespace loom::test
