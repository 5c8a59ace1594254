// The radiance field where the answer is known in closed form.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "field_scene.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;

class FieldClosedForm : public FieldTest {};

/// A closed tetrahedron that looks and shines inwards: four triangles, which are integrated in closed form. Skew, so
/// that no row of texels lies along an edge, where a point would be in the planes of two walls.
SceneBuilder furnace(float albedo, float radiance) {
  SceneBuilder scene;
  const int wall = scene.material(glm::vec3(albedo), glm::vec3(radiance));
  const glm::vec3 a(1, .9f, 1.1f), b(-1.1f, -1, .8f), c(-.8f, 1.2f, -1), d(1, -1.1f, -.9f);
  scene.triangle(a, b, c, wall).triangle(a, d, b, wall).triangle(a, c, d, wall).triangle(b, d, c, wall);
  return scene;
}

// E_k = πL_e·ρᵏ after k reflections, so that bounces = N gives πL_e·(ρ + … + ρᴺ) and all of them with the straight part
// πL_e/(1−ρ). A probe sees a constant, which cubes of any size hold; what is left is rounding of fp16 albedo (½ is
// exact).
TEST_F(FieldClosedForm, FurnaceOrderByOrder) {
  const double radiance = 2, albedo = .5;
  Bench bench(*device_, furnace(.5f, 2).build());
  bench.look({0, 0, 0}, {-.3, -.2, .4}, .3);
  double expected = 0, order = pi * radiance;
  for (int bounces = 1; bounces <= 4; ++bounces) {
    order *= albedo;
    expected += order;
    const auto set = of_field({{"probes", "5"}, {"face_size", "4"}, {"bounces", std::to_string(bounces)}});
    EXPECT_NEAR(bounce(bench, set), expected, 5e-4 * expected) << bounces;
  }
  const auto set = of_field({{"probes", "5"}, {"face_size", "4"}, {"bounces", "16"}});
  const double all = pi * radiance / (1 - albedo);
  const BenchOptions every_order{.size = {16, 16}, .set = set, .disabled_rules = {"bounces"}};
  EXPECT_NEAR(bench.image(field_pipeline, "indirect.irradiance.irradiance", every_order).mean().x, all, 5e-4 * all);
  // The rule leaves out what all orders from the tenth on hold, .5¹⁰ of all light.
  EXPECT_NEAR(mean(bench, "indirect.irradiance.irradiance", set), all, (5e-4 + 1e-3) * all);
}

// The same light, whatever the order of the harmonics: a constant is in band 0. One sample a texel of 8² leaves
// 6e-4 of it in band 4.
TEST_F(FieldClosedForm, FurnaceAtEveryOrderOfHarmonics) {
  Bench bench(*device_, furnace(.5f, 2).build());
  bench.look({0, 0, 0}, {-.3, -.2, .4}, .3);
  for (const char* order : {"0", "2", "4"}) {
    const auto set = of_field({{"probes", "3"}, {"bounces", "1"}, {"order", order}});
    EXPECT_NEAR(bounce(bench, set), pi, 1e-3 * pi) << order;
  }
}

// Twelve Gaussians hold a constant to a hundredth.
TEST_F(FieldClosedForm, FurnaceInGaussians) {
  Bench bench(*device_, furnace(.5f, 2).build());
  bench.look({0, 0, 0}, {-.3, -.2, .4}, .3);
  EXPECT_NEAR(bounce(bench, of_field({{"probes", "3"}, {"bounces", "1"}, {"basis", "sg"}})), pi, .01 * pi);
}

// A plane sees no other surface: all of its light comes straight from the sky, none by a bounce.
TEST_F(FieldClosedForm, SkyOverAPlaneIsAllEmitter) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 50, scene.material(glm::vec3(.7f))).sky(glm::vec3(3));
  Bench bench(*device_, scene.build());
  bench.look_down(5, 10);
  const auto set = of_field({{"probes", "4"}});
  EXPECT_EQ(bounce(bench, set), 0);
  EXPECT_NEAR(mean(bench, "indirect.irradiance.irradiance", set), pi * 3, 1e-5 * pi * 3);
}

// A plate that looks down on a plane under the sky, itself too small to shade it: E = ρ·πL from the plane alone.
TEST_F(FieldClosedForm, SkyReachesADownwardPlateByOneBounce) {
  SceneBuilder scene;
  const int ground = scene.material(glm::vec3(.5f)), black = scene.material(glm::vec3(0));
  scene.floor(glm::vec3(0), 30, ground).sky(glm::vec3(2));
  const float h = 10;
  scene.quad({-.5f, h, -.5f}, {.5f, h, -.5f}, {.5f, h, .5f}, {-.5f, h, .5f}, black);
  Bench bench(*device_, scene.build());
  bench.look({0, 9, .01}, {0, 10, 0}, .1);
  // The disc inscribed in the square of half side 30 is R²/(R²+h²) = .9 of the hemisphere, the one around it .947.
  const double e = bounce(bench, of_field({{"probes", "13"}, {"bounces", "1"}, {"emitter_rays", "16"}}), 8);
  EXPECT_GT(e, .88 * pi);
  EXPECT_LT(e, .96 * pi);
}

// Plate 1 shines, both reflect: E2 = πL1, E1 = πL2 with L1 = L_e/(1−ρ1ρ2), L2 = ρ2·L1; the straight part of E2 is πL_e.
// The plates end at 10 gaps, which takes 1 % of each crossing.
TEST_F(FieldClosedForm, ParallelPlates) {
  const double rho1 = .4, rho2 = .7, l1 = 2 / (1 - rho1 * rho2);
  SceneBuilder scene;
  const int one = scene.material(glm::vec3(.4f), glm::vec3(2)), two = scene.material(glm::vec3(.7f));
  scene.floor(glm::vec3(0), 10, one);
  scene.quad({-10, 1, -10}, {10, 1, -10}, {10, 1, 10}, {-10, 1, 10}, two);
  Bench bench(*device_, scene.build());
  const auto set = of_field({{"probes", "21"}, {"face_size", "4"}, {"bounces", "12"}});
  bench.look({0, .5, 0}, {0, 1, .01}, .2, {0, 0, 1});
  EXPECT_NEAR(mean(bench, "indirect.irradiance.irradiance", set, 8), pi * l1, .03 * pi * l1);
  EXPECT_NEAR(bounce(bench, set, 8), pi * (l1 - 2), .05 * pi * (l1 - 2));
  bench.look({0, .5, 0}, {0, 0, .01}, .2, {0, 0, 1});
  EXPECT_NEAR(bounce(bench, set, 8), pi * rho2 * l1, .03 * pi * rho2 * l1);
}

// A light of flux Φ in the middle of a sphere: the k-th bounce is E = ρᵏΦ/(4πR²) everywhere. 24 rings of flat facets
// stay within 1 − cos(π/24) = .9 % of the radius.
TEST_F(FieldClosedForm, IntegratingSphere) {
  SceneBuilder scene;
  const int wall = scene.material(glm::vec3(.5f));
  constexpr int rings = 24;
  const auto at = [](int ring, int step) {
    const double theta = pi * ring / rings, phi = pi * step / rings;
    return glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < 2 * rings; ++step) {
      const glm::vec3 a = at(ring, step), b = at(ring, step + 1), c = at(ring + 1, step), d = at(ring + 1, step + 1);
      if (ring > 0) scene.triangle(a, c, b, wall);
      if (ring + 1 < rings) scene.triangle(b, c, d, wall);
    }
  }
  scene.point({0, 0, 0}, glm::vec3(1));
  Bench bench(*device_, scene.build());
  bench.look({.1, 0, 0}, {-.5, .3, .4}, .5);
  double expected = 0, order = 1;  // Φ/(4πR²) = I/R²
  for (int bounces = 1; bounces <= 3; ++bounces) {
    order *= .5;
    expected += order;
    const auto set = of_field({{"probes", "6"}, {"bounces", std::to_string(bounces)}});
    EXPECT_NEAR(bounce(bench, set), expected, .01 * expected) << bounces;
  }
}

// What the walls absorb is what the light sends: Σ A·E·(1−ρ) = Φ, by six views, with the light off the middle.
TEST_F(FieldClosedForm, AClosedBoxAbsorbsTheWholeFlux) {
  SceneBuilder scene;
  add_room(scene, glm::vec3(-1), glm::vec3(1), scene.material(glm::vec3(.5f)));
  scene.point({.3f, -.2f, .1f}, glm::vec3(1));
  Bench bench(*device_, scene.build());
  const auto set = of_field({{"probes", "6"}, {"bounces", "10"}});
  double absorbed = 0;
  for (int side = 0; side < 6; ++side) {
    scene::Camera camera;
    camera.eye = {0, 0, 0};
    camera.target = glm::dvec3(0);
    camera.target[side / 2] = side % 2 == 0 ? 1 : -1;
    camera.up = side / 2 == 1 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    camera.orthographic = true;
    camera.xmag = camera.ymag = 1;
    camera.znear = 1e-3;
    bench.look(camera);
    const double e = bounce(bench, set) + mean(bench, "direct.irradiance.irradiance", set);
    absorbed += 4 * e * .5;
  }
  EXPECT_NEAR(absorbed, 4 * pi, .03 * 4 * pi);
}

}  // namespace
}  // namespace loom::test
