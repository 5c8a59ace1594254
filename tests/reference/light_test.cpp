// Light straight from lamps, emitters and sky, against closed forms.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "reference/scenes.h"
#include "support/hand_scene.h"

namespace loom::reference::test {
namespace {

constexpr double pi = std::numbers::pi;
using Look = SceneBuilder::Look;

/// A floor of 2·half around the origin, facing up.
SceneBuilder floor(float half, const Look& look = {.albedo = glm::vec3(.5F)}) {
  SceneBuilder b;
  b.quad({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}, look);
  return b;
}

/// Looks at `half` metres around a point of the floor, small enough to be one point.
scene::Camera onto(glm::dvec3 target, double half = 1e-3) { return probe(target + glm::dvec3(0, .5, 0), target, half); }

Estimate at_point(const scene::Scene& scene, Layer quantity, glm::dvec3 target, const Options& options = {}) {
  return over_pixels(render(scene, onto(target), {16, 16}, 16, options), quantity);
}

// E = I·cosθ/d²; the 2 mm of the view are worth 1e-6 of it.
TEST(PunctualLight, PointFollowsTheInverseSquare) {
  const auto scene = floor(5).point({0, 2, 0}, {1, 2, 4}).scene;
  expect_mean(at_point(scene, Layer::direct, {0, 0, 0}), glm::dvec3(1, 2, 4) / 4.);
  const double squared = 2 * 2 + 1.5 * 1.5;
  expect_mean(at_point(scene, Layer::direct, {1.5, 0, 0}), glm::dvec3(1, 2, 4) * 2. / std::pow(squared, 1.5));
}

TEST(PunctualLight, DirectionalIsItsIrradianceTimesCosine) {
  const auto scene = floor(5).directional({1, -1, 0}, {3, 2, 1}).scene;
  expect_mean(at_point(scene, Layer::direct, {0, 0, 0}), glm::dvec3(3, 2, 1) / std::sqrt(2.));
}

// clamp((c−c_o)/max(.001, c_i−c_o), 0, 1)² times the point light.
TEST(PunctualLight, SpotFallsOffBetweenItsAngles) {
  const double inner = 20, outer = 40;
  const auto scene = floor(5).spot({0, 1, 0}, {0, -1, 0}, glm::vec3(10), inner, outer).scene;
  for (const double degrees : {0., 15., 25., 30., 38., 45.}) {
    SCOPED_TRACE(degrees);
    const double angle = degrees * pi / 180;
    const double c = std::cos(angle), co = std::cos(outer * pi / 180), ci = std::cos(inner * pi / 180);
    const double falloff = std::pow(std::clamp((c - co) / (ci - co), 0., 1.), 2);
    const auto seen = at_point(scene, Layer::direct, {std::tan(angle), 0, 0});
    // Within 2 mm the falloff itself changes by up to 2·.002/(c_i−c_o), evenly about the middle: second order remains.
    expect_mean(seen, glm::dvec3(10 * falloff * c * c * c), 1e-4);
  }
}

TEST(PunctualLight, HardSpotHasNoFalloff) {
  const auto scene = floor(5).spot({0, 1, 0}, {0, -1, 0}, glm::vec3(10), 30, 30).scene;
  const double c = std::cos(.2);
  expect_mean(at_point(scene, Layer::direct, {std::tan(.2), 0, 0}), glm::dvec3(10 * c * c * c));
  EXPECT_EQ(at_point(scene, Layer::direct, {std::tan(.6), 0, 0}).mean, glm::dvec3(0));
}

// Many lights, one of them chosen a sample: the sum is that of each alone.
TEST(PunctualLight, LightsAddUp) {
  SceneBuilder all = floor(5);
  glm::dvec3 sum(0);
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 position(i - 2, 1 + .5 * i, .3 * i);
    const glm::vec3 intensity(1, static_cast<float>(i), 5 - static_cast<float>(i));
    all.point(position, intensity);
    sum += at_point(floor(5).point(position, intensity).scene, Layer::direct, {.2, 0, 0}).mean;
  }
  expect_mean_within(at_point(all.scene, Layer::direct, {.2, 0, 0}), sum, .05);
}

TEST(PunctualLight, IsBlockedByWhatIsBetween) {
  SceneBuilder b = floor(5);
  b.point({0, 2, 0}, glm::vec3(1));
  b.quad({-.1F, 1, -.1F}, {.2F, 0, 0}, {0, 0, .2F}, {.albedo = glm::vec3(.5F)});
  const auto under = probe({0, .5, 0}, {0, 0, 0}, 1e-3);
  EXPECT_EQ(over_pixels(render(b.scene, under, {4, 4}, 16), Layer::direct).mean, glm::dvec3(0));
  EXPECT_GT(at_point(b.scene, Layer::direct, {1, 0, 0}).mean.x, 0);
}

// A uniform sky over an unshadowed plane: E = πL.
TEST(Sky, OverAPlane) {
  const auto scene = floor(5).sky({1, 2, 3}).scene;
  expect_mean(at_point(scene, Layer::emitter, {0, 0, 0}), pi * glm::dvec3(1, 2, 3));
}

// A plane tilted by θ over an infinite black ground sees the sky's share (1+cosθ)/2 of it.
TEST(Sky, OverATiltedPlaneAndBlackGround) {
  for (const double degrees : {30., 60., 90., 120.}) {
    SCOPED_TRACE(degrees);
    const double t = degrees * pi / 180;
    const glm::vec3 normal(static_cast<float>(std::sin(t)), static_cast<float>(std::cos(t)), 0);
    const glm::vec3 u(0, 0, .02F);
    const glm::vec3 v = glm::cross(normal, u);
    SceneBuilder b = floor(1e4F, {});
    b.sky({1, 1, 1});
    const glm::vec3 centre(0, 1, 0);
    b.quad(centre - .5F * (u + v), u, v, {.albedo = glm::vec3(.5F)});
    const glm::dvec3 c(centre);
    const Film film = render(b.scene, probe(c + .1 * glm::dvec3(normal), c, 5e-3), {16, 16}, 64);
    expect_mean_within(over_pixels(film, Layer::emitter), glm::dvec3(pi * (1 + std::cos(t)) / 2), .05);
  }
}

TEST(Sky, IsTheBackground) {
  const auto scene = floor(1).sky({.25F, .5F, 1}).scene;
  const Film film = render(scene, probe({0, 1, 0}, {0, 2, 0}, 1), {4, 4}, 16);
  EXPECT_EQ(over_pixels(film, Layer::radiance).mean, glm::dvec3(.25, .5, 1));
  EXPECT_EQ(over_pixels(film, Layer::emitter).mean, glm::dvec3(0));
}

// Under the centre of a unit Lambert square one metre up: E/(πL) = .23946.
TEST(Emitter, PointUnderASquare) {
  SceneBuilder b = floor(5);
  b.quad({-.5F, 1, -.5F}, {1, 0, 0}, {0, 0, 1}, {.emissive = {1, 2, 3}});
  expect_mean_within(at_point(b.scene, Layer::emitter, {0, 0, 0}), .23946 * pi * glm::dvec3(1, 2, 3), .02);
}

// Form factors of two unit squares: E on one, averaged over it, is πL·F.
TEST(Emitter, FormFactorsOfUnitSquares) {
  for (const auto& [distance, factor] : {std::pair(1.F, .199825), {.5F, .415253}, {2.F, .068590}}) {
    SCOPED_TRACE(distance);
    SceneBuilder b;
    b.quad({-.5F, 0, -.5F}, {0, 0, 1}, {1, 0, 0}, {.albedo = glm::vec3(.5F)});
    b.quad({-.5F, distance, -.5F}, {1, 0, 0}, {0, 0, 1}, {.emissive = glm::vec3(1)});
    const Film film = render(b.scene, probe({0, .1, 0}, {0, 0, 0}, .5), {32, 32}, 64, {.bounces = 0});
    // The spread of the pixels is that of E over the square: stratified, its mean is far better than that.
    EXPECT_NEAR(over_pixels(film, Layer::emitter).mean.x, pi * factor, 2e-3 * pi * factor);
  }
  SceneBuilder b;  // a shared edge at a right angle
  b.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {.albedo = glm::vec3(.5F)});
  b.quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.emissive = glm::vec3(1)});
  const Film film = render(b.scene, probe({.5, .1, .5}, {.5, 0, .5}, .5), {32, 32}, 64, {.bounces = 0});
  EXPECT_NEAR(over_pixels(film, Layer::emitter).mean.x, pi * .200044, 2e-3 * pi * .200044);
}

// Both ways of finding emitters are unbiased alone, and so is their mixture.
TEST(Emitter, LightSamplesCosineSamplesAndBothAgree) {
  SceneBuilder b = floor(5);
  b.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 1}, {.albedo = glm::vec3(.5F), .emissive = {1, 2, 3}});
  b.quad({2, 0, -1}, {0, 0, 2}, {0, 2, 0}, {.albedo = glm::vec3(.8F), .emissive = glm::vec3(.5F)});
  b.sky(glm::vec3(.3F));
  for (const Layer q : {Layer::emitter, Layer::bounce}) {
    Estimate by[3];
    for (const Strategy s : {Strategy::mis, Strategy::light, Strategy::bsdf}) {
      by[static_cast<int>(s)] =
          over_pixels(render(b.scene, onto({.3, 0, 0}), {16, 16}, 128, {.bounces = 3, .strategy = s}), q);
    }
    for (const int other : {1, 2}) {
      const auto& e = by[other].error;
      expect_mean_within({by[other].mean, e}, by[0].mean, .1);
      expect_mean({by[0].mean, glm::sqrt(e * e + by[0].error * by[0].error)}, by[other].mean);
    }
  }
}

// The back of a single-sided face reflects but does not emit; a double-sided one emits on both sides.
TEST(Emitter, EmitsOnItsFrontOrOnBothSides) {
  for (const bool double_sided : {false, true}) {
    for (const bool faces_down : {false, true}) {
      SceneBuilder b = floor(5);
      const glm::vec3 x(1, 0, 0), z(0, 0, 1);
      b.quad({-.5F, 1, -.5F}, faces_down ? x : z, faces_down ? z : x,
             {.albedo = glm::vec3(.5F), .emissive = glm::vec3(1), .double_sided = double_sided});
      const bool lights = double_sided || faces_down;
      const Estimate e = at_point(b.scene, Layer::emitter, {0, 0, 0});
      if (lights) {
        expect_mean_within(e, glm::dvec3(.23946 * pi), .02);
      } else {
        EXPECT_EQ(e.mean, glm::dvec3(0));
      }
      // Seen from below it glows in the same cases.
      const Film below = render(b.scene, probe({0, .5, 0}, {0, 1, 0}, .1), {4, 4}, 16, {.bounces = 0});
      EXPECT_NEAR(over_pixels(below, Layer::radiance).mean.x, lights ? 1 : 0, 1e-6);
    }
  }
}

// A mirroring transform turns the winding around, not the side that emits.
TEST(Emitter, MirroredInstanceEmitsOnItsFront) {
  SceneBuilder b = floor(5);
  scene::Material lamp;
  lamp.emissive = glm::vec3(1);
  glm::dmat4 mirror(1);
  mirror[0][0] = -1;
  b.mesh(loom::test::quad({-.5F, 1, -.5F}, {1, 0, 0}, {0, 0, 1}), lamp, mirror);
  expect_mean_within(at_point(b.scene, Layer::emitter, {0, 0, 0}), glm::dvec3(.23946 * pi), .02);
}

}  // namespace
}  // namespace loom::reference::test
