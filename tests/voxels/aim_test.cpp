// Rays aimed at what shines most, beside cosine-distributed ones: the same mean, and less noise where the source is
// small.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include <glm/vec3.hpp>

#include "support/bench.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 16, "rays": 64 } },
    "radiosity": { "type": "Radiosity", "in": { "voxels": "voxelize.voxels" }, "params": { "bounces": 3 } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" }, "params": { "emitter": true } } },
  "outputs": { "image": "march.irradiance" } })";

class AimTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels irradiance(Bench& bench, int rays, int aimed) {
    return bench.image(pipeline, "image",
                       {.size = {32, 32},
                        .set = {{"march", "rays", std::to_string(rays)}, {"march", "aimed", std::to_string(aimed)}}});
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

double deviation(const Texels& image) {
  const double mean = image.mean().x;
  double square = 0;
  for (const glm::vec4& texel : image.values) square += std::pow(texel.x - mean, 2);
  return std::sqrt(square / static_cast<double>(image.values.size()));
}

/// Share of the hemisphere's cosine-weighted directions that a square of side 2a at height h fills, seen from below its
/// middle.
double square_above(double a, double h) {
  const double x = a / h, root = std::sqrt(1 + x * x);
  return 4 * x / (pi * root) * std::atan(x / root);
}

TEST_F(AimTest, ASmallSourceIsMetWithoutNoise) {
  const float half = .06F;
  const glm::vec3 radiance{100, 50, 25};
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(0)));
  scene.quad({-half, 1, -half}, {half, 1, -half}, {half, 1, half}, {-half, 1, half},
             scene.material(glm::vec3(0), radiance));
  Bench bench(*device_, scene.build());
  bench.look({.01, .5, .01}, {0, 0, 0}, .02, {0, 0, 1});
  const double expected = pi * static_cast<double>(radiance.x) * square_above(half, 1);
  const Texels by_chance = irradiance(bench, 16, 0), aimed = irradiance(bench, 12, 4);
  // The square is .84 cells wide, and known to 1/255 of a cell on each side.
  EXPECT_NEAR(aimed.mean().x, expected, .015 * expected);
  EXPECT_NEAR(aimed.mean().z, expected / 4, .015 * expected / 4);
  EXPECT_LT(deviation(aimed), .1 * deviation(by_chance));
}

// Where everything shines alike, aiming adds nothing and takes nothing away: E = π·L_e·(1 + ρ + ρ² + ρ³).
TEST_F(AimTest, AFurnaceStaysAFurnace) {
  const float albedo = .6F;
  scene::Scene scene;
  scene.materials = {diffuse(glm::vec3(albedo), glm::vec3(1))};
  add_box(scene, {-1.01F, -.83F, -1.27F}, {1.01F, .83F, 1.27F}, 0, true);
  finish(scene);
  Bench bench(*device_, scene);
  bench.look({.4, .1, -.3}, {-.8, -.4, .9}, .5);
  double series = 0;
  for (int k = 0; k <= 3; ++k) series += std::pow(albedo, k);
  const double aimed = irradiance(bench, 8, 8).mean().x;
  EXPECT_NEAR(aimed, irradiance(bench, 16, 0).mean().x, .005 * aimed);
  EXPECT_NEAR(aimed, pi * series, .02 * pi * series);
}

TEST_F(AimTest, NothingShines) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(.5F)));
  Bench bench(*device_, scene.build());
  bench.look_down(.5);
  EXPECT_EQ(irradiance(bench, 4, 4).mean().x, 0);
}

}  // namespace
}  // namespace loom::test
