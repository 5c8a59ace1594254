// AreaLight against form factors and skies in closed form.
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
constexpr glm::vec3 radiance{2, 1, .5f};

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "emitter": { "type": "AreaLight", "in": { "surface": "gbuffer.surface" } } },
  "outputs": { "image": "emitter.irradiance" } })";

class Area : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels irradiance(Bench& bench, int size, std::vector<graph::Override> set = {}, std::uint32_t seed = 0) {
    return bench.image(pipeline, "image", {.size = {size, size}, .set = std::move(set), .seed = seed});
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// A unit square at height h about the axis that shines down on a large floor.
SceneBuilder lamp(float h, float floor_half = 20) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), floor_half, scene.material(glm::vec3(.5)));
  const int light = scene.material(glm::vec3(0), radiance);
  scene.quad({-.5f, h, -.5f}, {.5f, h, -.5f}, {.5f, h, .5f}, {-.5f, h, .5f}, light);
  return scene;
}

/// E/(πL) at a point under the corner of a rectangle a×b at height 1 (times h), parallel to it.
double corner_factor(double a, double b) {
  const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * pi);
}

TEST_F(Area, PointUnderTheCentreOfAUnitSquare) {
  EXPECT_NEAR(4 * corner_factor(.5, .5), .23946, 1e-5);
  Bench bench(*device_, lamp(1).build());
  bench.look_down(1e-4, .5);
  for (const char* samples : {"1", "16"}) {
    const Texels e = irradiance(bench, 4, {{"emitter", "samples", samples}});
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(e.mean()[c] / (pi * radiance[c]), 4 * corner_factor(.5, .5), 2e-6) << samples;
  }
}

TEST_F(Area, EveryPointUnderASquareWithNothingInBetween) {
  Bench bench(*device_, lamp(1).build());
  bench.look_down(3, .5);
  const Texels e = irradiance(bench, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 p = bench.position(x, y, .5);
      // Four corners, signed by the side on which the point lies.
      double factor = 0;
      for (const double sx : {-1., 1.}) {
        for (const double sz : {-1., 1.}) {
          const double a = .5 + sx * p.x, b = .5 + sz * p.z;
          factor += std::copysign(1., a) * std::copysign(1., b) * corner_factor(std::abs(a), std::abs(b));
        }
      }
      ASSERT_NEAR(e.at(x, y).x / (pi * radiance.x), factor, 2e-6) << p.x << ' ' << p.z;
    }
  }
}

TEST_F(Area, FormFactorsOfParallelUnitSquares) {
  struct Case {
    float distance;
    double factor;
  };
  for (const Case& c : {Case{1, .199825}, Case{.5f, .415253}, Case{2, .068590}}) {
    Bench bench(*device_, lamp(c.distance).build());
    bench.look_down(.5, .5 * c.distance);
    // Mean over the pixels' centres: a midpoint rule, error about E''/24·(1/64)² of a function that bends by 1/d².
    EXPECT_NEAR(irradiance(bench, 64).mean().x / (pi * radiance.x), c.factor, 2e-5 / (c.distance * c.distance));
  }
}

TEST_F(Area, FormFactorOfSquaresThatShareAnEdge) {
  SceneBuilder scene;
  scene.floor({0, 0, 0}, 1, scene.material(glm::vec3(.5)));
  const int light = scene.material(glm::vec3(0), radiance);
  // A unit square in the plane x = −.5 that faces +x; the receiver is the unit square of the floor beside it.
  scene.quad({-.5f, 0, -.5f}, {-.5f, 1, -.5f}, {-.5f, 1, .5f}, {-.5f, 0, .5f}, light);
  Bench bench(*device_, scene.build());
  bench.look_down(.5, 2);
  // Along the edge E falls from half with a slope that is unbounded (like x·log x): error of the midpoint rule ~h²log
  // h.
  EXPECT_NEAR(irradiance(bench, 64).mean().x / (pi * radiance.x), .200044, 2e-4);
}

TEST_F(Area, TheHorizonCutsATiltedReceiver) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  scene.quad({0, -.1f, .1f}, {0, -.1f, -.1f}, {0, .1f, -.1f}, {0, .1f, .1f}, grey);  // faces +x
  const int light = scene.material(glm::vec3(0), radiance);
  // A huge horizontal ceiling at y = 1 shining down: a vertical receiver sees half of it, E = πL/2.
  scene.quad({-9e3f, 1, -9e3f}, {9e3f, 1, -9e3f}, {9e3f, 1, 9e3f}, {-9e3f, 1, 9e3f}, light);
  Bench bench(*device_, scene.build());
  bench.look({.5, 0, 0}, {0, 0, 0}, .01);
  EXPECT_NEAR(irradiance(bench, 4).mean().x / (pi * radiance.x), .5, 1e-3);
}

TEST_F(Area, ABlockerThatCoversTheLightLeavesNothing) {
  SceneBuilder scene = lamp(1);
  const int grey = scene.material(glm::vec3(.5));
  scene.quad({-2, .9f, -2}, {2, .9f, -2}, {2, .9f, 2}, {-2, .9f, 2}, grey);
  Bench bench(*device_, scene.build());
  bench.look_down(.5, .5);
  EXPECT_EQ(irradiance(bench, 16).mean().x, 0);
  EXPECT_GT(irradiance(bench, 16, {{"emitter", "visibility", "none"}}).mean().x, 1);
}

TEST_F(Area, ABlockerOfHalfTheLightLeavesHalf) {
  SceneBuilder scene = lamp(1);
  const int grey = scene.material(glm::vec3(.5));
  scene.quad({0, .9f, -9}, {9, .9f, -9}, {9, .9f, 9}, {0, .9f, 9}, grey);
  Bench bench(*device_, scene.build());
  bench.look_down(1e-3, .5);
  // 32² pixels × 64 rays on two triangles, stratified: far below this tolerance in noise; the ratio's bias is O(1/32).
  const Texels e = irradiance(bench, 32, {{"emitter", "samples", "64"}});
  EXPECT_NEAR(e.mean().x / (pi * radiance.x), .5 * 4 * corner_factor(.5, .5), .005 * .24);
}

TEST_F(Area, ManyEmittersSampledByPowerAgreeWithTheClosedForm) {
  SceneBuilder scene = lamp(1);
  const int dim = scene.material(glm::vec3(0), .1f * radiance);
  scene.quad({2, 0, -.5f}, {2, 0, .5f}, {2, 1, .5f}, {2, 1, -.5f}, dim);
  const int blocker = scene.material(glm::vec3(.5));
  scene.quad({-.2f, .6f, -.2f}, {.2f, .6f, -.2f}, {.2f, .6f, .2f}, {-.2f, .6f, .2f}, blocker);
  Bench bench(*device_, scene.build());
  bench.look_down(1.5, .5);
  const Texels closed = irradiance(bench, 32, {{"emitter", "samples", "256"}});
  const Texels sampled = irradiance(bench, 32, {{"emitter", "samples", "256"}, {"emitter", "closed_form", "0"}});
  EXPECT_NEAR(sampled.mean().x / closed.mean().x, 1, .005);
  EXPECT_GT(closed.mean().x, .1);
}

TEST_F(Area, SkyOnATiltedPlaneOverBlackGround) {
  for (const double tilt : {0., pi / 3, pi / 2}) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(.5));
    scene.floor({0, -1, 0}, 2e4f, grey).sky(radiance);
    const glm::vec3 n(static_cast<float>(std::sin(tilt)), static_cast<float>(std::cos(tilt)), 0);
    const glm::vec3 s(n.y, -n.x, 0), t(0, 0, 1);
    scene.quad(-s * .1f + t * .1f, s * .1f + t * .1f, s * .1f - t * .1f, -s * .1f - t * .1f, grey);
    Bench bench(*device_, scene.build());
    bench.look(glm::dvec3(n), {0, 0, 0}, .02, glm::dvec3(t));
    const Texels e = irradiance(bench, 32, {{"emitter", "samples", "64"}});
    // 65536 stratified rays: σ < .5/256 even if they were independent.
    EXPECT_NEAR(e.mean().x / (pi * radiance.x), .5 * (1 + std::cos(tilt)), tilt == 0 ? 1e-6 : .004) << tilt;
  }
}

TEST_F(Area, AWallBlocksHalfOfTheSky) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  scene.floor(glm::vec3(0), 1, grey).sky(radiance);
  scene.quad({-.01f, 0, 500}, {-.01f, 0, -500}, {-.01f, 500, -500}, {-.01f, 500, 500}, grey);
  Bench bench(*device_, scene.build());
  bench.look_down(.005, 2);
  const Texels e = irradiance(bench, 32, {{"emitter", "samples", "64"}});
  EXPECT_NEAR(e.mean().x / (pi * radiance.x), .5, .004);
  EXPECT_FLOAT_EQ(irradiance(bench, 4, {{"emitter", "visibility", "none"}}).mean().x,
                  static_cast<float>(pi) * radiance.x);
}

TEST_F(Area, TheBackOfASingleSidedEmitterIsDarkAndADoubleSidedOneShinesBothWays) {
  for (const bool both : {false, true}) {
    SceneBuilder scene;
    scene.floor(glm::vec3(0), 20, scene.material(glm::vec3(.5)));
    const int light = scene.material(glm::vec3(0), radiance, both);
    scene.quad({-.5f, 1, .5f}, {.5f, 1, .5f}, {.5f, 1, -.5f}, {-.5f, 1, -.5f}, light);  // faces up
    Bench bench(*device_, scene.build());
    bench.look_down(1e-4, .5);
    for (const char* few : {"8", "0"}) {
      const float e = irradiance(bench, 8, {{"emitter", "closed_form", few}, {"emitter", "samples", "64"}}).mean().x;
      if (both) {
        EXPECT_NEAR(e / (pi * radiance.x), .23946, few[0] == '8' ? 1e-5 : .01);
      } else {
        EXPECT_EQ(e, 0);
      }
    }
  }
}

TEST_F(Area, AnEmitterDoesNotLightItsOwnPlane) {
  SceneBuilder scene;
  const int light = scene.material(glm::vec3(.5), radiance, true);
  scene.floor({0, .3f, 0}, 1, light);
  Bench bench(*device_, scene.build());
  bench.look({.2, 1.7, 1.1}, {0, .3, 0}, .4);
  EXPECT_EQ(irradiance(bench, 32).mean().x, 0);
  EXPECT_EQ(irradiance(bench, 32, {{"emitter", "closed_form", "0"}}).mean().x, 0);
}

TEST_F(Area, NothingThatEmitsIsAbsentOrZero) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(.5)));
  Bench bench(*device_, scene.build());
  bench.look_down(.5);
  bench.render(pipeline, {.requested = {"image"}});
  EXPECT_TRUE(bench.absent("image"));
  bench.render(pipeline, {.requested = {"image"}, .prune = false});
  EXPECT_EQ(bench.read("image").mean().x, 0);
}

TEST_F(Area, TheSameSeedGivesTheSameImageAndAnotherOneAnother) {
  SceneBuilder scene = lamp(1);
  const int grey = scene.material(glm::vec3(.5));
  scene.quad({0, .6f, -.3f}, {.3f, .6f, -.3f}, {.3f, .6f, .3f}, {0, .6f, .3f}, grey);
  Bench bench(*device_, scene.build());
  bench.look_down(1, .5);
  const Texels a = irradiance(bench, 32, {}, 7), b = irradiance(bench, 32, {}, 7), c = irradiance(bench, 32, {}, 8);
  EXPECT_TRUE(a == b);
  EXPECT_FALSE(a == c);
}

}  // namespace
}  // namespace loom::test
