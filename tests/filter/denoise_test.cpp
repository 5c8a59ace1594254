// Denoise against the kernel's closed forms, and at edges.
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "filter/filter_test.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979;

class DenoiseTest : public FilterTest {
 protected:
  /// `value` filtered.
  Texels smooth(Bench& bench, const std::string& value, int iterations, int size = 64,
                const std::string& params = "") const {
    const std::string passes = source(value) + R"(, "denoise": { "type": "Denoise",
      "in": { "noisy": "source.e", "surface": "gbuffer.surface" }, "params": { "iterations": )" +
                               std::to_string(iterations) + params + " } }";
    return bench.image(pipeline(passes, R"("image": "denoise.irradiance", "depth": "gbuffer.surface.depth",
      "albedo": "gbuffer.surface.albedo")"),
                       "image", {.size = {size, size}, .requested = {"depth", "albedo"}});
  }
  /// The block from the side and above.
  std::unique_ptr<Bench> aslant() const {
    auto bench = std::make_unique<Bench>(*device_, block());
    bench->look({3, 2.5, 4}, {0, .3, 0}, .4);
    return bench;
  }
};

TEST_F(DenoiseTest, AConstantStaysWhatItIsToTheBit) {
  const auto bench = aslant();
  for (const int iterations : {1, 2, 3, 5}) {
    const Texels filtered = smooth(*bench, "vec3(.3, 1e5, 1e-5)", iterations);
    const Texels depth = bench->read("depth");
    int seen = 0;
    for (std::size_t i = 0; i < filtered.values.size(); ++i) {
      const bool surface = depth.values[i].x > 0;
      seen += surface ? 1 : 0;
      ASSERT_EQ(glm::vec3(filtered.values[i]), surface ? glm::vec3(.3F, 1e5F, 1e-5F) : glm::vec3(0)) << iterations;
    }
    EXPECT_GT(seen, 1000);
  }
}

// On a plane seen head-on all edge weights are 1: what one pixel becomes is the product of the à-trous splines, which
// sums to 1.
TEST_F(DenoiseTest, AnImpulseBecomesTheSpline) {
  Bench bench(*device_, plane());
  bench.look_down(1);
  constexpr std::array<double, 5> spline{1. / 16, 4. / 16, 6. / 16, 4. / 16, 1. / 16};
  const std::string impulse = "vec3(pixel == ivec2(32, 32) ? 1 : 0)";
  const Texels once = smooth(bench, impulse, 1);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const int dx = x - 30, dy = y - 30;
      const bool inside = dx >= 0 && dx < 5 && dy >= 0 && dy < 5;
      const double expected = inside ? spline[static_cast<std::size_t>(dx)] * spline[static_cast<std::size_t>(dy)] : 0.;
      ASSERT_NEAR(once.at(x, y).x, expected, 1e-6) << x << ' ' << y;
    }
  }
  for (const int iterations : {2, 3}) {
    const Texels wide = smooth(bench, impulse, iterations);
    EXPECT_NEAR(64 * 64 * static_cast<double>(wide.mean().x), 1, 1e-5);
    const int reach = 2 * ((1 << iterations) - 1);
    EXPECT_GT(wide.at(32 + reach, 32).x, 0);
    EXPECT_EQ(wide.at(32 + reach + 1, 32).x, 0);
  }
}

// White noise keeps Σh² of its variance: (70/256)² after one iteration, since Σ(1 4 6 4 1)²/256 = 70/256.
TEST_F(DenoiseTest, WhiteNoiseKeepsTheKernelsPower) {
  Bench bench(*device_, plane());
  bench.look_down(1);
  const Texels filtered = smooth(bench, "uniform_noise", 1, 128);
  double square = 0, n = 0;
  for (int y = 2; y < 126; ++y)
    for (int x = 2; x < 126; ++x)
      for (int c = 0; c < 3; ++c, ++n) square += std::pow(filtered.at(x, y)[c] - .5, 2);
  // 46128 values, correlated over some four pixels each: 5 % is four standard deviations.
  EXPECT_NEAR(square / n, 70. * 70 / (256 * 256) / 12, .05 * 70 * 70 / (256 * 256) / 12);
}

// The block's top lies some fifteen footprints above the floor; its sides meet it at right angles.
TEST_F(DenoiseTest, NothingCrossesAnEdge) {
  const auto bench = aslant();
  const std::string two = "vec3(albedo > .5 ? 100 : 1)";
  const Texels filtered = smooth(*bench, two, 4);
  const Texels depth = bench->read("depth"), albedo = bench->read("albedo");
  int bright = 0, dark = 0;
  for (std::size_t i = 0; i < filtered.values.size(); ++i) {
    if (depth.values[i].x <= 0) continue;
    const bool is_bright = albedo.values[i].x > .5F;
    ++(is_bright ? bright : dark);
    ASSERT_EQ(filtered.values[i].x, is_bright ? 100.F : 1.F) << i;
  }
  EXPECT_GT(bright, 300);
  EXPECT_GT(dark, 300);
  // Without the guides they do mix.
  const Texels mixed = smooth(*bench, two, 4, 64, R"(, "plane_sigma": 100, "normal_exponent": 0)");
  int between = 0;
  for (const glm::vec4& texel : mixed.values) between += texel.x > 2 && texel.x < 99 ? 1 : 0;
  EXPECT_GT(between, 300);
}

// A plane seen at 80° is one surface: as much is averaged over as head-on, however far its depths lie apart.
TEST_F(DenoiseTest, ASlopeIsNoEdge) {
  Bench bench(*device_, plane());
  bench.look({0, 1, 0}, {0, 1 - std::cos(80 * pi / 180), -std::sin(80 * pi / 180)}, .05);
  const Texels filtered = smooth(bench, "vec3(pixel == ivec2(32, 32) ? 1 : 0)", 1);
  EXPECT_NEAR(filtered.at(32, 32).x, 9. / 64, 1e-3);
  EXPECT_NEAR(filtered.at(32, 34).x, 3. / 8 / 16, 1e-3);
}

// Interpolated normals lean away from the triangle: with k = 0 they do not count, and the triangle is one plane.
TEST_F(DenoiseTest, PlanesAreThoseOfTheTriangles) {
  scene::Scene scene = plane();
  for (scene::Mesh& mesh : scene.meshes)
    for (glm::vec3& normal : mesh.primitives.front().normals) normal = glm::normalize(glm::vec3(1, 1, 0));
  Bench bench(*device_, std::move(scene));
  bench.look_down(1);
  const Texels filtered =
      smooth(bench, "vec3(pixel == ivec2(32, 32) ? 1 : 0)", 1, 64, R"(, "normal_exponent": 0, "plane_sigma": 0.01)");
  EXPECT_NEAR(filtered.at(34, 32).x, 3. / 8 / 16, 1e-6);
}

TEST_F(DenoiseTest, WhatIsNotFiniteIsFilledFromItsNeighbours) {
  Bench bench(*device_, plane());
  bench.look_down(1);
  const Texels filtered = smooth(bench,
                                 "pixel == ivec2(9, 9) ? vec3(0. / 0.) : pixel == ivec2(20, 9) ? vec3(1e38 * 1e38) : "
                                 "vec3(.7)",
                                 3, 32);
  for (const glm::vec4& texel : filtered.values) ASSERT_EQ(texel.x, .7F);
}

TEST_F(DenoiseTest, NoIterationsLetEverythingThrough) {
  Bench bench(*device_, plane());
  bench.look_down(1);
  const Texels filtered = smooth(bench, "vec3(pixel, 3)", 0, 16);
  EXPECT_EQ(glm::vec3(filtered.at(5, 7)), glm::vec3(5, 7, 3));
  EXPECT_FALSE(bench.renderer().graph().pass("denoise")->runs);
}

}  // namespace
}  // namespace loom::test
