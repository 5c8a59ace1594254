// InstantRadiosity and GatherVpls against closed forms, and what may change a set of virtual lights.
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

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 20 } },
    "vpls": { "type": "InstantRadiosity", "params": { "paths": 1024, "renew": "never" } },
    "bounce": { "type": "GatherVpls", "in": { "surface": "gbuffer.surface", "vpls": "vpls.vpls",
                                              "voxels": "voxelize.voxels" } } },
  "outputs": { "image": "bounce.irradiance", "clamped": "bounce.clamped", "counts": "vpls.counts" } })";

using Overrides = std::vector<graph::Override>;

struct Counts {
  double lights, kept, paths, watts;
};

class VplTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels image(Bench& bench, Overrides set, int size = 16) {
    return bench.image(pipeline, "image", {.size = {size, size}, .set = std::move(set), .requested = {"image"}});
  }
  static double mean(Bench& bench, Overrides set, int size = 16) { return image(bench, std::move(set), size).mean().x; }
  static Counts counts(Bench& bench) {
    const glm::vec4 v = bench.read("counts").at(0, 0);
    return {v.x, v.y, v.z, v.w};
  }
  static Counts counts_of(Bench& bench, Overrides set) {
    bench.render(pipeline, {.size = {4, 4}, .set = std::move(set), .requested = {"counts"}});
    return counts(bench);
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

// A disc of exitant radiance L = ρE⊥/π gives the point at height h on its axis E = πL·R²/(R²+h²). A disc of 64 sides
// has .9984 of the area; 4096 lights on a low-discrepancy set leave less than another half percent.
TEST_F(VplTest, ALitDisc) {
  const float radius = 1.5F, rho = .6F;
  for (const float h : {.75F, 1.5F, 3.F}) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(rho)), black = scene.material(glm::vec3(0));
    for (int i = 0; i < 64; ++i) {
      const auto at = [&](int k) {
        const double angle = 2 * pi * k / 64;
        return radius * glm::vec3(std::cos(angle), 0, -std::sin(angle));
      };
      scene.triangle(glm::vec3(0), at(i), at(i + 1), grey);
    }
    // A receiver that looks down, too small to shade the disc.
    scene.quad({-.01F, h, -.01F}, {.01F, h, -.01F}, {.01F, h, .01F}, {-.01F, h, .01F}, black);
    scene.directional(glm::normalize(glm::vec3(1, -1, 0)), glm::vec3(5));
    Bench bench(*device_, scene.build());
    bench.look({0, h - .1, .001}, {0, h, 0}, .03, {0, 0, 1});
    const double expected = rho * 5 * std::sqrt(.5) * radius * radius / (radius * radius + h * h);
    const Overrides set{{"vpls", "paths", "8192"}, {"vpls", "bounces", "1"}, {"bounce", "min_distance", "0"}};
    EXPECT_NEAR(mean(bench, set, 4), expected, .01 * expected) << h;
  }
}

// In a sphere every pair of points has the geometry term 1/(4R²): whatever the lights' places, bounce k gives
// ρᵏΦ/(4πR²). 24 rings of flat facets stay within .9 % of the radius.
TEST_F(VplTest, IntegratingSphereOrderByOrder) {
  const float rho = .6F, radius = 1.3F;
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(rho))};
  add_sphere(scene, {.1F, 0, -.2F}, radius, 24, 0, true);
  add_point_light(scene, {.1, 0, -.2}, glm::vec3(5));
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.1, .2, -.2}, {1, -.4, .3}, .6);
  for (const char* roulette : {"albedo", "none"}) {
    double series = 0;
    for (int k = 1; k <= 3; ++k) {
      series += std::pow(rho, k) * 5 / (radius * radius);
      // Roulette leaves a standard error of √((1−ρ)/ρ/1024) = 2.5 % of the second order and what follows.
      const double bound = roulette == std::string("albedo") ? .04 : .02;
      const Overrides set{
          {"vpls", "bounces", std::to_string(k)}, {"vpls", "roulette", roulette}, {"bounce", "min_distance", "0"}};
      EXPECT_NEAR(mean(bench, set, 8), series, bound * series) << roulette << ' ' << k;
    }
  }
}

// Every wall shines: E = πL_e(ρ + … + ρⁿ).
TEST_F(VplTest, FurnaceIsAGeometricSeries) {
  scene::Scene scene;
  const glm::vec3 albedo{.8F, .5F, .1F}, emission{1, 2, .3F};
  scene.materials = {diffuse(albedo, emission)};
  add_box(scene, {-1.01F, -.83F, -1.27F}, {1.01F, .83F, 1.27F}, 0, true);
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  for (const int bounces : {1, 3}) {
    const glm::vec4 e = image(bench, {{"vpls", "bounces", std::to_string(bounces)},
                                      {"vpls", "roulette", "none"},
                                      {"vpls", "paths", "2048"},
                                      {"bounce", "min_distance", "0"}})
                            .mean();
    for (int c = 0; c < 3; ++c) {
      double series = 0;
      for (int k = 1; k <= bounces; ++k) series += std::pow(albedo[c], k);
      EXPECT_NEAR(e[c], pi * emission[c] * series, .03 * pi * emission[c] * series) << bounces << ' ' << c;
    }
  }
}

// The flux of all lights of a closed room is Φ(ρ + … + ρⁿ), from every kind of source.
TEST_F(VplTest, FluxIsConserved) {
  const float rho = .5F;
  const auto room = [&](bool lamp) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(rho)), light = scene.material(glm::vec3(0), glm::vec3(3));
    const glm::vec3 l(-1), h(1);
    const SceneBuilder outwards = SceneBuilder().box(l, h, 0);
    for (const scene::Mesh& mesh : outwards.build().meshes) {
      const auto& p = mesh.primitives[0].positions;
      scene.triangle(p[0], p[2], p[1], grey);
    }
    // Two black squares of .4 × .4 m, one of which shines downwards.
    if (lamp) scene.quad({-.2F, .9F, -.2F}, {.2F, .9F, -.2F}, {.2F, .9F, .2F}, {-.2F, .9F, .2F}, light);
    return scene;
  };
  const Overrides set{{"vpls", "bounces", "2"}, {"vpls", "roulette", "none"}};
  Bench point(*device_, room(false).point({.3F, .1F, .2F}, glm::vec3(2)).build());
  EXPECT_NEAR(counts_of(point, set).watts, 8 * pi * .75, 1e-4 * 8 * pi * .75);
  Bench spot(*device_, room(false).spot({0, .9F, 0}, {0, -1, 0}, glm::vec3(2), .4999, .5).build());
  // Its edge falls off as a square over .001 of the cosine (the least of KHR_lights_punctual), of which a third is
  // left.
  const double cone = 4 * pi * (1 - std::cos(.5) - 2. / 3 * .001);
  EXPECT_NEAR(counts_of(spot, set).watts, cone * .75, .001 * cone * .75);
  Bench lamp(*device_, room(true).build());
  const double emitted = pi * 3 * .16;
  // Little of what walls send back is lost in the black lamp.
  EXPECT_NEAR(counts_of(lamp, {{"vpls", "bounces", "1"}}).watts, emitted * .5, 1e-4 * emitted);
  // Sky and sun over a square of 4 m²: what it reflects of πL·A and E·A.
  SceneBuilder open;
  open.floor(glm::vec3(0), 1, open.material(glm::vec3(rho))).sky(glm::vec3(2));
  Bench sky(*device_, open.build());
  EXPECT_NEAR(counts_of(sky, {{"vpls", "paths", "8192"}}).watts, pi * 2 * 4, .02 * pi * 2 * 4);
  SceneBuilder sunny;
  sunny.floor(glm::vec3(0), 1, sunny.material(glm::vec3(rho)));
  sunny.directional(glm::normalize(glm::vec3(.3F, -1, .1F)), glm::vec3(7));
  Bench sun(*device_, sunny.build());
  const double arriving = 7 * 4 / std::sqrt(1.1);
  EXPECT_NEAR(counts_of(sun, {{"vpls", "paths", "8192"}}).watts, .5 * arriving, .01 * .5 * arriving);
}

/// A corner: a floor and a wall, lit by one light.
SceneBuilder corner(float gain = 1) {
  SceneBuilder scene;
  const int grey = scene.material({.7F, .5F, .3F});
  scene.floor(glm::vec3(0), 1, grey);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey);
  scene.spot({.5F, 1, .3F}, {-.2F, -.6F, -.7F}, gain * glm::vec3(4, 3, 2), .7, .9);
  return scene;
}

void look_into_corner(Bench& bench) { bench.look({0, 1, 1.5}, {0, .1, -.9}, .3); }

// What the bound leaves and what it takes away is the unbounded sum.
TEST_F(VplTest, ClampedIsWhatIsMissing) {
  Bench bench(*device_, corner().build());
  look_into_corner(bench);
  const Texels all = image(bench, {{"bounce", "min_distance", "0"}});
  bench.render(pipeline,
               {.size = {16, 16}, .set = {{"bounce", "min_distance", "3"}}, .requested = {"image", "clamped"}});
  const Texels given = bench.read("image"), taken = bench.read("clamped");
  EXPECT_GT(taken.mean().x, .005 * all.mean().x);
  for (std::size_t i = 0; i < all.values.size(); ++i) {
    EXPECT_NEAR(given.values[i].x + taken.values[i].x, all.values[i].x, 1e-5 * all.values[i].x);
  }
}

// Compensation finds what the bound took away: with it, few lights and a low bound have the mean of many lights.
TEST_F(VplTest, CompensationBringsBackWhatIsClamped) {
  Bench bench(*device_, corner().build());
  look_into_corner(bench);
  const double truth = mean(bench, {{"vpls", "paths", "16384"}, {"vpls", "roulette", "none"}}, 8);
  const Overrides bounded{{"bounce", "min_distance", "16"}, {"vpls", "roulette", "none"}};
  Overrides compensated = bounded;
  compensated.push_back({"bounce", "compensation", "64"});
  EXPECT_LT(mean(bench, bounded, 8), .9 * truth);
  EXPECT_NEAR(mean(bench, compensated, 8), truth, .015 * truth);
}

// The error of the bounded sum falls as the lights grow in number: the bound goes away with them.
TEST_F(VplTest, ConvergesAsLightsGrow) {
  Bench bench(*device_, corner().build());
  bench.look({0, 1, .9}, {0, 0, .1}, .3);
  const Texels truth = image(bench, {{"vpls", "paths", "16384"}});
  double last = 1e9;
  for (const char* paths : {"16", "128", "1024"}) {
    const Texels some = image(bench, {{"vpls", "paths", paths}});
    double error = 0;
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
      error += std::pow(some.values[i].x - truth.values[i].x, 2);
    }
    EXPECT_LT(error, .4 * last) << paths;
    last = error;
  }
}

// The parts that the pixels of a tile take are all of the lights: where every pixel sees the same, the mean over tiles
// is the full sum, and two iterations of the filter leave nothing of a pattern of four pixels.
TEST_F(VplTest, InterleavedPartsAddUp) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.7F)), black = scene.material(glm::vec3(0));
  scene.floor(glm::vec3(0), 1, grey);
  scene.quad({-.01F, 2, -.01F}, {.01F, 2, -.01F}, {.01F, 2, .01F}, {-.01F, 2, .01F}, black);
  scene.directional(glm::normalize(glm::vec3(1, -1, 0)), glm::vec3(5));
  Bench bench(*device_, scene.build());
  bench.look({0, 1.9, .001}, {0, 2, 0}, .002, {0, 0, 1});
  const double full = mean(bench, {});
  EXPECT_NEAR(mean(bench, {{"bounce", "interleave", "4"}}), full, 1e-3 * full);
  const std::string filtered = std::string(pipeline).insert(
      std::string(pipeline).find("} },\n  \"outputs\""),
      R"(}, "denoise": { "type": "Denoise", "in": { "noisy": "bounce.irradiance", "surface": "gbuffer.surface" },
                     "params": { "iterations": 2, "plane_sigma": 100 } )");
  const Texels smooth = bench.image(filtered, "denoise.irradiance.irradiance",
                                    {.size = {32, 32}, .set = {{"bounce", "interleave", "4"}}});
  for (int y = 8; y < 24; ++y) {
    for (int x = 8; x < 24; ++x) EXPECT_NEAR(smooth.at(x, y).x, full, 2e-3 * full) << x << ' ' << y;
  }
}

// Two rooms and a wall: rays let nothing through, voxels little.
TEST_F(VplTest, WallsBlock) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.7F));
  scene.floor(glm::vec3(0), 2, grey);
  scene.box({-.1F, 0, -2}, {.1F, 3, 2}, grey);
  scene.spot({-1.5F, 1, 0}, {.1F, -1, 0}, glm::vec3(5), .3, .6);
  scene.quad({1.9F, 0, -2}, {1.9F, 0, 2}, {1.9F, 2, 2}, {1.9F, 2, -2}, grey);
  Bench bench(*device_, scene.build());
  bench.look({.5, 1, 0}, {1.9, 1, 0}, .4);
  const Overrides one{{"vpls", "bounces", "1"}};
  const auto with = [&](const char* how) {
    Overrides set = one;
    set.push_back({"bounce", "visibility", how});
    return mean(bench, set);
  };
  const double open = with("none");
  EXPECT_GT(open, 1e-3);
  EXPECT_EQ(with("rays"), 0);
  EXPECT_LT(with("voxels"), 1e-3 * open);
  bench.look({-1.5, .6, 0}, {-.1, .6, 0}, .4);
  EXPECT_NEAR(with("rays"), with("none"), 1e-6 * with("none"));
  EXPECT_NEAR(with("voxels"), with("none"), .02 * with("none"));
}

// Twice the light is twice the result; metres to binary kilometres and millimetres change nothing.
TEST_F(VplTest, LinearInLightAndFreeOfUnits) {
  Bench once(*device_, corner().build()), twice(*device_, corner(2).build());
  look_into_corner(once);
  look_into_corner(twice);
  const Texels a = image(once, {}), b = image(twice, {});
  for (std::size_t i = 0; i < a.values.size(); ++i) EXPECT_EQ(2 * a.values[i].x, b.values[i].x);
  for (const float k : {0x1p-10F, 0x1p10F}) {
    scene::Scene scene = corner().build();
    for (scene::Mesh& mesh : scene.meshes)
      for (scene::Primitive& primitive : mesh.primitives)
        for (glm::vec3& position : primitive.positions) position *= k;
    for (scene::Light& light : scene.lights) {
      light.position *= k;
      light.intensity *= k * k;
    }
    Bench bench(*device_, scene);
    const double scale = k;
    bench.look(scale * glm::dvec3(0, 1, 1.5), scale * glm::dvec3(0, .1, -.9), .3);
    const Texels c = image(bench, {});
    double difference = 0, square = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
      difference += std::pow(c.values[i].x - a.values[i].x, 2);
      square += std::pow(a.values[i].x, 2);
    }
    EXPECT_LT(std::sqrt(difference / square), 1e-4) << k;
  }
}

// A light that moves a little keeps the lights that it still sees where they were, with the flux of now; the picture is
// that of a new set within the noise of either.
TEST_F(VplTest, ALightThatMovesKeepsWhatItSees) {
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(.5F))};
  add_box(scene, {-1.01F, -.83F, -1.27F}, {1.01F, .83F, 1.27F}, 0, true);
  add_box(scene, {-.6F, -.83F, -.3F}, {-.2F, 0, .3F}, 0);
  add_point_light(scene, {.3, .1, .2}, glm::vec3(5));
  scene.nodes.push_back({.light = 0});
  scene.animations.resize(1);
  scene.animations[0].channels.push_back({.node = static_cast<int>(scene.nodes.size()) - 1,
                                          .times = {0, 1},
                                          .values = {glm::vec4(.3F, .1F, .2F, 0), glm::vec4(.31F, .12F, .21F, 0)}});
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.9, .1, 1.1}, {-.8, -.4, -.9}, .4);
  const auto after = [&](const char* update, const char* paths) {
    bench.pose(0);
    bench.render(pipeline, {.size = {16, 16}, .set = {{"vpls", "update", update}, {"vpls", "paths", paths}}});
    bench.pose(1);
    bench.next_frame();
    const Counts c = counts(bench);
    return std::pair(bench.read("image").mean().x, c.kept / c.lights);
  };
  const auto [truth, none] = after("trace", "8192");
  const auto [traced, few] = after("trace", "1024");
  const auto [kept, many] = after("keep", "1024");
  EXPECT_LT(few, .05);
  EXPECT_GT(many, .6);
  EXPECT_NEAR(traced, truth, .02 * truth);
  EXPECT_NEAR(kept, truth, .02 * truth);
}

// An object that moves replaces the lights on it and in its shadow, and no others.
TEST_F(VplTest, WhatDoesNotChangeIsKept) {
  SceneBuilder scene = corner();
  scene.moving({.2F, 0, 0}).box({.1F, .2F, -.6F}, {.5F, .5F, -.3F}, 0);
  Bench bench(*device_, scene.build());
  look_into_corner(bench);
  bench.render(pipeline, {.size = {4, 4}, .requested = {"counts"}});
  EXPECT_EQ(counts(bench).kept, 0);
  bench.next_frame();
  const Counts still = counts(bench);
  EXPECT_GT(still.lights, 500);
  bench.pose(1);
  bench.next_frame();
  const Counts moved = counts(bench);
  EXPECT_LT(moved.kept, .95 * moved.lights);
  EXPECT_GT(moved.kept, .5 * moved.lights);
}

}  // namespace
}  // namespace loom::test
