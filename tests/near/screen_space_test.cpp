// ScreenSpaceGI against closed forms.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "near/near_test.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;
// Sides that the camera does not see send nothing, as what they are taken for is no matter of a closed form.
const std::string fine = R"("slices": 16, "steps": 64, "hidden": "dark")";

class ScreenSpace : public NearTest {};

TEST_F(ScreenSpace, APlaneSeesNothing) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1000, scene.material(glm::vec3(.5F), glm::vec3(3)));
  Bench bench(*device_, scene.build());
  for (const double tilt : {0., 5., 100.}) {
    bench.look({0, 10, .01 + tilt}, {0, 0, 0}, .5);
    const Texels e = bench.image(near_pipeline(), "image");
    for (const glm::vec4& texel : e.values) ASSERT_EQ(texel.x, 0) << tilt;
    // Nor is it stopped: half-float normals turn a plane by 2⁻¹¹, and the rays that low are few (sin² of it).
    const Texels shares = bench.image(near_pipeline(), "unknown");
    EXPECT_LT(shares.mean().y, 1e-5) << tilt;
  }
}

/// A wall of radiance 2 that stands on a floor which is dark.
scene::Scene corner(float radiance = 2, float unit = 1) {
  SceneBuilder scene;
  const float s = unit;
  scene.floor(glm::vec3(0), 2 * s, scene.material(glm::vec3(.5F)));
  scene.quad({-s, 0, -s}, {s, 0, -s}, {s, s, -s}, {-s, s, -s}, scene.material(glm::vec3(0), glm::vec3(radiance)));
  return scene.build();
}

void look_into_corner(Bench& bench, double unit = 1) {
  bench.look(glm::dvec3(0, 2.4, 2.6) * unit, glm::dvec3(0, .35, -.5) * unit, .45);
}

/// E/(πL) of a rectangle that stands square on the receiver's plane, its foot at distance d: Σ over its halves of
/// (atan(w/d) − d/√(d²+h²)·atan(w/√(d²+h²)))/2π.
double standing_factor(double left, double right, double h, double d) {
  const double far = std::hypot(d, h);
  const auto half = [&](double w) { return (std::atan(w / d) - d / far * std::atan(w / far)) / (2 * pi); };
  return half(left) + half(right);
}

TEST_F(ScreenSpace, AWallOnAFloorGivesItsFormFactor) {
  Bench bench(*device_, corner());
  look_into_corner(bench);
  const int size = 80;
  bench.render(near_pipeline(fine), {.size = {size, size}});
  const Texels e = bench.read("image"), depth = bench.read("depth"), normal = bench.read("normal");
  double error = 0, sum = 0, all = 0;
  int pixels = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (normal.at(x, y).y < .5F || depth.at(x, y).x <= 0) continue;
      const glm::dvec3 p = bench.position(x, y, depth.at(x, y).x);
      const double d = p.z + 1;
      // Nearer than three pixels to the wall the first texels decide.
      if (std::abs(p.x) > 1 || d < .1) continue;
      const double truth = 2 * pi * standing_factor(1 + p.x, 1 - p.x, 1, d);
      error += std::abs(e.at(x, y).x - truth);
      sum += e.at(x, y).x;
      all += truth;
      ++pixels;
    }
  }
  ASSERT_GT(pixels, 500);
  // 16 slices leave 2 % of noise a pixel; the border of the wall falls between texels.
  EXPECT_LT(error / all, .03);
  EXPECT_NEAR(sum / all, 1, .01);
}

TEST_F(ScreenSpace, WhatIsLostInTheCornerShrinksWithThePixel) {
  // AreaLight has the same closed form, at every pixel: beside the wall, behind it and on it, too.
  Bench bench(*device_, corner());
  look_into_corner(bench);
  const auto lost = [&](int size) {
    bench.render(near_pipeline(fine), {.size = {size, size}});
    return 1 - bench.read("image").mean().x / bench.read("emitter").mean().x;
  };
  const double coarse = lost(24), finer = lost(72);
  EXPECT_LT(coarse, .09);
  EXPECT_LT(finer, .5 * coarse);
  EXPECT_GT(finer, 0);
}

TEST_F(ScreenSpace, TwiceTheLightIsTwiceTheIrradiance) {
  Texels e[2];
  for (int k = 0; k < 2; ++k) {
    Bench bench(*device_, corner(k == 0 ? 1.F : 2.F));
    look_into_corner(bench);
    e[k] = bench.image(near_pipeline(), "image", {.size = {48, 48}});
  }
  for (std::size_t i = 0; i < e[0].values.size(); ++i) ASSERT_EQ(2 * e[0].values[i].x, e[1].values[i].x);
  EXPECT_GT(e[0].mean().x, 0);
}

TEST_F(ScreenSpace, UnitsDoNotMatter) {
  Texels e[2];
  for (int k = 0; k < 2; ++k) {
    const float unit = k == 0 ? 1.F : 1024.F;
    Bench bench(*device_, corner(2, unit));
    look_into_corner(bench, unit);
    e[k] = bench.image(
        near_pipeline(R"("radius": )" + std::to_string(unit) + R"(, "thickness": )" + std::to_string(.1F * unit)),
        "image", {.size = {48, 48}});
  }
  double difference = 0, square = 0;
  for (std::size_t i = 0; i < e[0].values.size(); ++i) {
    difference += std::pow(e[1].values[i].x - e[0].values[i].x, 2);
    square += std::pow(e[0].values[i].x, 2);
  }
  EXPECT_LT(std::sqrt(difference / square), 1e-4);
}

/// The part of a sphere of radius 1 about the origin within `angle` of its lowest point, shining inwards.
scene::Scene bowl(double angle) {
  constexpr int rings = 24, steps = 48;
  SceneBuilder scene;
  const int shining = scene.material(glm::vec3(0), glm::vec3(2));
  const auto at = [&](int ring, int step) {
    const double theta = angle * ring / rings, phi = 2 * pi * step / steps;
    return glm::vec3(std::sin(theta) * std::cos(phi), -std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < steps; ++step) {
      scene.triangle(at(ring, step), at(ring + 1, step + 1), at(ring + 1, step), shining);
      if (ring > 0) scene.triangle(at(ring, step), at(ring, step + 1), at(ring + 1, step + 1), shining);
    }
  }
  return scene.build();
}

TEST_F(ScreenSpace, AnyPointOfABowlSeesItsShareOfTheSphere) {
  // Between points of a sphere cosθ cosθ'/r² = 1/(4R²): E/(πL) is the bowl's share of the sphere's area.
  for (const double angle : {.5 * pi, pi / 3}) {
    Bench bench(*device_, bowl(angle));
    bench.look({0, 4, 0}, {0, -1, 0}, std::atan(1.1 * std::sin(angle) / (4 + std::cos(angle))), {0, 0, -1});
    const int size = 48;
    bench.render(near_pipeline(fine), {.size = {size, size}});
    const Texels e = bench.read("image"), depth = bench.read("depth");
    double sum = 0;
    int pixels = 0;
    for (std::size_t i = 0; i < e.values.size(); ++i) {
      if (depth.values[i].x <= 0) continue;
      sum += e.values[i].x;
      ++pixels;
    }
    const double truth = 2 * pi * (1 - std::cos(angle)) / 2;
    // Facets of 3.75° lie inside of the sphere by a thousandth, and hide their neighbours' last rays; rims are lost
    // where a bowl is seen edge-on.
    EXPECT_NEAR(sum / pixels / truth, 1, .02) << angle << ' ' << sum / pixels / truth;
  }
}

/// E/(πL) at distance h under the corner of a rectangle a×b that is parallel to the receiver.
double corner_factor(double a, double b, double h) {
  const double p = std::hypot(h, a), q = std::hypot(h, b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * pi);
}

TEST_F(ScreenSpace, WhatIsThinLetsRaysPassBehind) {
  // A plate at height h over a floor, from straight above, is taken for a box of the given thickness: seen from the
  // floor beside it, a rectangle parallel to the floor and one that stands square on it.
  constexpr float h = 1, from = .5F, to = 1.25F, side = 1.5F;
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F), glm::vec3(1));
  scene.floor(glm::vec3(0), 100, grey);
  scene.quad({from, h, side}, {to, h, side}, {to, h, -side}, {from, h, -side}, grey);
  Bench bench(*device_, scene.build());
  bench.look_down(2);
  constexpr int size = 64;
  for (const double thickness : {.1, .5}) {
    const Texels shares =
        bench.image(near_pipeline(R"("slices": 32, "steps": 64, "thickness": )" + std::to_string(thickness)), "unknown",
                    {.size = {size, size}, .requested = {"unknown"}});
    double hidden = 0;
    for (int y = 30; y < 34; ++y) hidden += shares.at(size / 2, y).y / 4;
    const double x = 2. / size, low = h - thickness;
    const double truth = 2 * (corner_factor(to - x, side, low) - corner_factor(from - x, side, low)) +
                         standing_factor(side, side, h, from - x) - standing_factor(side, side, low, from - x);
    EXPECT_NEAR(hidden, truth, .03 * truth) << thickness;
  }
}

TEST_F(ScreenSpace, RaysThatLeaveTheImageAreCounted) {
  // Over a floor seen from straight above (orthographic, w to each side) a ray at θ meets the border plane at distance
  // b(φ)/sinθ: a share 1 − (b/r)² of each slice; over all slices 1 − 4w²/(πr²), where r ≥ √2·w.
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 100, scene.material(glm::vec3(.5F), glm::vec3(1)));
  Bench bench(*device_, scene.build());
  bench.look_down(1);
  for (const double r : {1.5, 3.}) {
    const Texels shares =
        bench.image(near_pipeline(R"("slices": 32, "radius": )" + std::to_string(r)), "unknown", {.size = {33, 33}});
    EXPECT_NEAR(shares.at(16, 16).x, 1 - 4 / (pi * r * r), .02) << r;
    EXPECT_NEAR(shares.at(16, 16).z, 4 / (pi * r * r), .02) << r;
  }
  const Texels inside = bench.image(near_pipeline(R"("radius": 0.9)"), "unknown", {.size = {33, 33}});
  EXPECT_EQ(inside.at(16, 16).x, 0);
  EXPECT_EQ(inside.at(16, 16).z, 1);
}

TEST_F(ScreenSpace, NothingSeenAndOnePixelAreFine) {
  Bench bench(*device_, corner());
  bench.look({0, 1, 3}, {0, 1, 10}, .3);
  for (const glm::vec4& texel : bench.image(near_pipeline(), "image", {.size = {8, 8}}).values) EXPECT_EQ(texel.x, 0);
  look_into_corner(bench);
  EXPECT_EQ(bench.image(near_pipeline(), "image", {.size = {1, 1}}).values[0].x, 0);
  // From within the wall, and from under the floor.
  bench.look({0, .5, -1}, {0, 0, 0}, .5);
  for (const glm::vec4& texel : bench.image(near_pipeline(), "image").values)
    ASSERT_TRUE(std::isfinite(texel.x) && texel.x >= 0);
  bench.look({0, -1, 1}, {0, 0, -1}, .5);
  for (const glm::vec4& texel : bench.image(near_pipeline(), "image").values)
    ASSERT_TRUE(std::isfinite(texel.x) && texel.x >= 0);
}

}  // namespace
}  // namespace loom::test
