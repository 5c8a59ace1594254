// ScreenSpaceGI on top of a far field, and AmbientOcclusion.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "near/near_test.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;

class NearField : public NearTest {};
class Openness : public NearTest {};

/// A room with two boxes in it, all of one albedo and emission.
scene::Scene room(float albedo, float emission) {
  SceneBuilder scene;
  const int wall = scene.material(glm::vec3(albedo), glm::vec3(emission), true);
  scene.box({-2, 0, -2}, {2, 3, 2}, wall)
      .box({-1.2F, 0, -1}, {-.2F, 1.5F, 0}, wall)
      .box({.2F, 0, 0}, {1, .8F, .8F}, wall);
  return scene.build();
}

void look_in(Bench& bench) { bench.look({1.5, 2.2, 1.8}, {-.4, .6, -.4}, .6); }

/// `near` over a far field of irradiance π·`far`.
std::string over(const std::string& source, const std::string& hidden, float radius) {
  return R"({ "passes": { )" + source + R"(,
      "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface" } },
      "near": { "type": "ScreenSpaceGI",
        "in": { "surface": "gbuffer.surface", "radiance": "lit.radiance", "far": "source.e" },
        "params": { "hidden": ")" +
         hidden + R"(", "radius": )" + std::to_string(radius) + R"( } } },
      "outputs": { "image": "near.irradiance", "unknown": "near.unknown" } })";
}

TEST_F(NearField, InAFurnaceNoLightIsCountedTwiceNorLost) {
  // Every surface sends the radiance 3, and the far field holds that: E = 3π whatever part of it comes from where.
  Bench bench(*device_, room(0, 3));
  look_in(bench);
  const std::string field = source("vec3(3. * 3.14159265)");
  for (const char* hidden : {"front", "far"}) {
    for (const float radius : {.2F, .5F, 2.F, 100.F}) {
      bench.render(over(field, hidden, radius), {.size = {32, 32}});
      for (const glm::vec4& e : bench.read("image").values) ASSERT_NEAR(e.x, 3 * pi, 3e-6 * pi) << hidden << radius;
      const glm::vec4 shares = bench.read("unknown").mean();
      // The test is one only where a part of the rays ends nearby, and a part does not.
      const float ended = 1 - shares.x - shares.z;
      EXPECT_GT(ended, .003) << radius;
      EXPECT_LT(ended, .9) << radius;
    }
  }
}

TEST_F(NearField, DarkSurfacesNearbyTakeTheirShareOfTheFarField) {
  Bench bench(*device_, room(0, 0));
  look_in(bench);
  bench.render(over(source("vec3(2)"), "dark", .5F), {.size = {32, 32}});
  const Texels e = bench.read("image"), shares = bench.read("unknown");
  for (std::size_t i = 0; i < e.values.size(); ++i)
    ASSERT_NEAR(e.values[i].x, 2 * (shares.values[i].x + shares.values[i].z), 1e-5);
  EXPECT_LT(e.mean().x, 1.95);
}

TEST_F(NearField, OverAPropagationVolumeAFurnaceKeepsItsOrders) {
  // L_e = 1, ρ = ½: n orders of reflection make E = π·Σ ρᵏ, k = 1 … n; the near field, which reflects what the far one
  // brings once more, lies between that and the next. The volume's own error is taken out by giving it the truth.
  Bench bench(*device_, room(.5F, 1));
  look_in(bench);
  const std::string pipeline = R"({ "passes": { )" + source("vec3(3.14159265 * (.5 + .25 + .125))") + R"(,
      "emitter": { "type": "AreaLight", "in": { "surface": "gbuffer.surface" }, "params": { "closed_form": 256, "samples": 144 } },
      "received": { "type": "Add", "in": { "a": "source.e", "b": "emitter.irradiance" } },
      "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface", "indirect": "received.irradiance" }, "params": { "parts": "reflected" } },
      "near": { "type": "ScreenSpaceGI", "in": { "surface": "gbuffer.surface", "radiance": "lit.radiance", "far": "source.e" }, "params": { "radius": 1 } } },
      "outputs": { "image": "near.irradiance", "emitter": "emitter.irradiance" } })";
  bench.render(pipeline, {.size = {32, 32}});
  EXPECT_NEAR(bench.read("emitter").mean().x, pi, .01 * pi);
  const double orders = bench.read("image").mean().x / pi;
  EXPECT_GT(orders, .875 * .999);
  EXPECT_LT(orders, .9375 * 1.001);
}

/// Σ over a grid on the wall x ∈ [−1, 1], y ∈ [0, 1], z = −1, seen from p on a floor: ∫ Y_lm ⟨n,ω⟩₊ dω.
std::array<double, 9> wall_transfer(const glm::dvec3& p) {
  constexpr int steps = 64;
  std::array<double, 9> sum{};
  for (int i = 0; i < 2 * steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const glm::dvec3 d = glm::dvec3(-1 + (i + .5) / steps, (j + .5) / steps, -1) - p;
      const double r = glm::length(d);
      const double x = d.x / r, y = d.y / r, z = d.z / r;
      const double w = y * -z / (r * r) / (steps * steps);
      const std::array<double, 9> basis{.282095,
                                        .488603 * y,
                                        .488603 * z,
                                        .488603 * x,
                                        1.092548 * x * y,
                                        1.092548 * y * z,
                                        .315392 * (3 * z * z - 1),
                                        1.092548 * x * z,
                                        .546274 * (x * x - y * y)};
      for (std::size_t k = 0; k < 9; ++k) sum[k] += w * basis[k];
    }
  }
  return sum;
}

TEST_F(NearField, WhatEndsIsKnownByDirection) {
  // A wall on a floor: `ended` holds the cosine-weighted harmonics of the directions in which the wall stands.
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F), glm::vec3(1));
  scene.floor(glm::vec3(0), 2, grey).quad({-1, 0, -1}, {1, 0, -1}, {1, 1, -1}, {-1, 1, -1}, grey);
  Bench bench(*device_, scene.build());
  bench.look({0, 2.4, 2.6}, {0, .35, -.5}, .45);
  constexpr int size = 64;
  // `far`: rays that meet the thickness of the wall do not end. A part of the size has it at every pixel, too.
  for (const char* resolution : {"1", "2"}) {
    bench.render(R"({ "passes": { "gbuffer": { "type": "GBuffer" },
        "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface" } },
        "near": { "type": "ScreenSpaceGI", "in": { "surface": "gbuffer.surface", "radiance": "lit.radiance" },
                  "params": { "slices": 16, "steps": 64, "hidden": "far" } } },
        "outputs": { "image": "near.irradiance", "ended": "near.ended.image",
                     "depth": "gbuffer.surface.depth", "normal": "gbuffer.surface.normal" } })",
                 {.size = {size, size}, .set = {{"near", "resolution", resolution}}});
    const Texels ended = bench.read("ended"), depth = bench.read("depth"), normal = bench.read("normal");
    std::array<double, 9> error{};
    double first = 0;
    int pixels = 0;
    for (int y = 0; y < size; y += 3) {
      for (int x = 0; x < size; x += 3) {
        if (normal.at(x, y).y < .5F || depth.at(x, y).x <= 0) continue;
        const glm::dvec3 p = bench.position(x, y, depth.at(x, y).x);
        if (std::abs(p.x) > .8 || p.z < -.7) continue;
        const auto truth = wall_transfer(p);
        for (int k = 0; k < 9; ++k)
          error[static_cast<std::size_t>(k)] += ended.at(x, y, k / 4)[k % 4] - truth[static_cast<std::size_t>(k)];
        first += truth[0];
        ++pixels;
      }
    }
    ASSERT_GT(pixels, 50);
    // Of the mean, in parts of c00: a texel is an eighteenth of the wall, and the share of half a one is lost.
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(error[k] / first, 0, .04) << k << ' ' << resolution;
  }
}

TEST_F(NearField, ThePipelineOfAFieldKeepsAFurnace) {
  // L_e = 1, ρ = ½: near light and the field less what has ended add up to the orders of the field, π·(½ + ¼ + ⅛), or
  // one more where the near field reflects once more.
  Bench bench(*device_, room(.5F, 1));
  look_in(bench);
  for (const char* basis : {"sh", "sg"}) {
    bench.render("radiance-field-near.json",
                 {.size = {24, 24},
                  .set = {{"field", "probes", "4"},
                          {"field", "face_size", "8"},
                          {"field", "bounces", "3"},
                          {"field", "emitter_rays", "64"},
                          {"field", "basis", basis},
                          {"near", "radius", "1"}},
                  .requested = {"bounce", "unknown", "bounce.irradiance", "beyond.irradiance"}});
    const double orders = bench.read("bounce").mean().x / pi;
    EXPECT_GT(orders, .875 * .97) << basis;
    EXPECT_LT(orders, .9375 * 1.03) << basis;
    // What is left of the field is the share of rays that have not ended, but for what a probe's texels hold unevenly.
    const glm::vec4 shares = bench.read("unknown").mean();
    const double left = shares.x + shares.y + shares.z;
    EXPECT_LT(left, .95);
    EXPECT_NEAR(bench.read("beyond.irradiance").mean().x / bench.read("bounce.irradiance").mean().x, left, .01)
        << basis;
  }
}

std::string ambient(const std::string& params) {
  return R"({ "passes": { "gbuffer": { "type": "GBuffer" },
      "open": { "type": "AmbientOcclusion", "in": { "surface": "gbuffer.surface" }, "params": { "ambient": [2, 1, 0.5], )" +
         params + R"( } } }, "outputs": { "image": "open.irradiance" } })";
}

TEST_F(Openness, AnOpenPlaneGetsAllOfIt) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1000, scene.material(glm::vec3(.5F)));
  Bench bench(*device_, scene.build());
  bench.look({0, 5, 5}, {0, 0, 0}, .4);
  for (const glm::vec4& e : bench.image(ambient(R"("radius": 100)"), "image").values) {
    ASSERT_NEAR(e.x, 2 * pi, 1e-5);
    ASSERT_EQ(e.y, e.x / 2);
    ASSERT_EQ(e.z, e.x / 4);
  }
}

TEST_F(Openness, HalfIsLeftBesideAHighWall) {
  // Beside an endless wall half of the cosine-weighted hemisphere is open, and within the radius r, at distance d of
  // it, 1 − (1 − (d/r)²)/2: the share of a slice at φ to the wall's normal is 1 − (d/(r cosφ))².
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  scene.floor(glm::vec3(0), 400, grey).quad({-400, 0, 0}, {400, 0, 0}, {400, 800, 0}, {-400, 800, 0}, grey);
  Bench bench(*device_, scene.build());
  bench.look({0, 3, 6}, {0, 0, 0}, .45);
  constexpr int size = 64;
  bench.render(R"({ "passes": { "gbuffer": { "type": "GBuffer" },
      "open": { "type": "AmbientOcclusion", "in": { "surface": "gbuffer.surface" },
                "params": { "ambient": [1, 1, 1], "radius": 1, "slices": 32, "steps": 64 } } },
      "outputs": { "image": "open.irradiance", "depth": "gbuffer.surface.depth", "normal": "gbuffer.surface.normal" } })",
               {.size = {size, size}});
  const Texels e = bench.read("image"), depth = bench.read("depth"), normal = bench.read("normal");
  double sum = 0, truth = 0;
  int pixels = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double d = bench.position(x, y, depth.at(x, y).x).z;
      if (normal.at(x, y).y < .5F || d < .3 || d > 1.2) continue;
      // Over −φ₁ … φ₁, cosφ₁ = d/r: (2φ₁ − 2d²tanφ₁)/2π of the hemisphere.
      const double phi = d < 1 ? std::acos(d) : 0;
      truth += pi * (1 - (phi - d * d * std::tan(phi)) / pi);
      sum += e.at(x, y).x;
      ++pixels;
    }
  }
  ASSERT_GT(pixels, 300);
  EXPECT_NEAR(sum / truth, 1, .01);
}

TEST_F(Openness, TheMeanOfAFieldIsTheRadianceOfAFurnace) {
  // ρ = ½, L_e = 1: a field of n orders holds Σ ρᵏ, k = 1 … n, everywhere.
  Bench bench(*device_, room(.5F, 1));
  look_in(bench);
  const std::string pipeline = R"({ "passes": { "gbuffer": { "type": "GBuffer" },
      "field": { "type": "RadianceField", "params": { "probes": 4, "face_size": 6, "order": 1, "bounces": 2, "emitter_rays": 64 } },
      "open": { "type": "AmbientOcclusion", "in": { "surface": "gbuffer.surface", "field": "field.field" }, "params": { "radius": 0.001 } } },
      "outputs": { "image": "open.irradiance" } })";
  for (const char* basis : {"sh", "sg"}) {
    const Texels e = bench.image(pipeline, "image", {.size = {8, 8}, .set = {{"field", "basis", basis}}});
    EXPECT_NEAR(e.mean().x, .75 * pi, .03 * pi) << basis;
  }
}

}  // namespace
}  // namespace loom::test
