// Accumulate against exact means, and what it keeps and drops while the camera moves.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "filter/filter_test.h"

namespace loom::test {
namespace {

class AccumulateTest : public FilterTest {
 protected:
  std::string accumulate(const std::string& value, const std::string& params) const {
    return pipeline(source(value) + R"(, "accumulate": { "type": "Accumulate", "in": { "noisy": "source.e",
      "surface": "gbuffer.surface", "last": "accumulate.irradiance@prev", "last_length": "accumulate.length@prev",
      "last_surface": "gbuffer.surface@prev" }, "params": { )" +
                        params + " } }",
                    R"("image": "accumulate.irradiance", "length": "accumulate.length", "source": "source.e",
      "depth": "gbuffer.surface.depth", "albedo": "gbuffer.surface.albedo")");
  }
  static BenchOptions options(int size) {
    return {.size = {size, size}, .requested = {"image", "length", "source", "depth", "albedo"}};
  }
  /// Past the block, `step` metres further along x each frame.
  static void fly(Bench& bench, int frame, double step) {
    bench.look({-1 + step * frame, 2.5, 4}, {-1 + step * frame, .3, 0}, .4);
  }
  static double mean_square_error(const Texels& image, double expected) {
    double sum = 0;
    for (const glm::vec4& texel : image.values)
      for (int c = 0; c < 3; ++c) sum += std::pow(texel[c] - expected, 2) / 3;
    return sum / static_cast<double>(image.values.size());
  }
};

TEST_F(AccumulateTest, AtRestItIsTheMeanAndItsVarianceFallsAsOneOverN) {
  Bench bench(*device_, plane());
  bench.look({0, 3, 3}, {0, 0, 0}, .3);
  std::vector<glm::dvec3> sum(48 * 48);
  for (int n = 1; n <= 64; ++n) {
    n == 1 ? bench.render(accumulate("uniform_noise", R"("max_history": 1000)"), options(48)) : bench.next_frame();
    const Texels source = bench.read("source");
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += glm::dvec3(source.values[i]);
    if ((n & (n - 1)) != 0) continue;
    const Texels mean = bench.read("image"), length = bench.read("length");
    for (std::size_t i = 0; i < sum.size(); ++i) {
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(mean.values[i][c], sum[i][c] / n, 2e-6) << n;
      ASSERT_EQ(length.values[i].x, static_cast<float>(n));
    }
    // Variance of uniform noise 1/12; of 6912 values the estimate is good to 1.7 % (one standard deviation).
    EXPECT_NEAR(mean_square_error(mean, .5), 1. / 12 / n, .08 / 12 / n) << n;
  }
}

TEST_F(AccumulateTest, BeyondItsHistoryTheVarianceIsThatOfAnExponentialMean) {
  Bench bench(*device_, plane());
  bench.look({0, 3, 3}, {0, 0, 0}, .3);
  BenchOptions how = options(48);
  how.frames = 80;
  bench.render(accumulate("uniform_noise", R"("max_history": 8)"), how);
  EXPECT_EQ(bench.read("length").mean().x, 8);
  const double expected = 1. / 15 / 12;  // α/(2−α), α = 1/8
  EXPECT_NEAR(mean_square_error(bench.read("image"), .5), expected, .08 * expected);
}

TEST_F(AccumulateTest, TheFirstFrameAndTheOneAfterAResetAreTheSource) {
  Bench bench(*device_, block());
  fly(bench, 0, 0);
  bench.render(accumulate("uniform_noise", ""), options(32));
  const auto is_source = [&] {
    const Texels source = bench.read("source"), image = bench.read("image"), depth = bench.read("depth");
    for (std::size_t i = 0; i < image.values.size(); ++i)
      if (depth.values[i].x > 0 && image.values[i] != source.values[i]) return false;
    return true;
  };
  EXPECT_TRUE(is_source());
  bench.next_frame();
  EXPECT_FALSE(is_source());
  bench.reset();
  bench.next_frame();
  EXPECT_TRUE(is_source());
}

// The block is a hundred times as bright as the floor. What a pixel of the floor shows after the block has moved away
// from it is the floor's own value.
TEST_F(AccumulateTest, NothingIsDraggedAlongFromAnotherSurface) {
  const std::string two = "vec3(albedo > .5 ? 100 : 1)";
  for (const bool guided : {true, false}) {
    Bench bench(*device_, block());
    int wrong = 0;
    double length = 0, seen = 0;
    for (int frame = 0; frame < 12; ++frame) {
      fly(bench, frame, .15);
      frame == 0
          ? bench.render(accumulate(two, guided ? "" : R"("plane_distance": 100, "normal_angle": 180)"), options(64))
          : bench.next_frame();
      const Texels image = bench.read("image"), source = bench.read("source"), frames = bench.read("length");
      const Texels depth = bench.read("depth");
      for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (depth.values[i].x <= 0) continue;
        wrong += std::abs(image.values[i].x - source.values[i].x) > 1e-5F * source.values[i].x ? 1 : 0;
        if (frame == 11) {
          length += frames.values[i].x;
          ++seen;
        }
      }
    }
    if (guided) {
      EXPECT_EQ(wrong, 0);
      EXPECT_GT(length / seen, 8) << "what is seen on and on is kept";
    } else {
      EXPECT_GT(wrong, 100) << "without the guides it is";
    }
  }
}

// Irradiance that is linear over the floor: what is carried along stays with its place, to the second-order error of a
// bilinear read in perspective.
TEST_F(AccumulateTest, TheMeanStaysWithItsPlaceWhileTheCameraMoves) {
  Bench bench(*device_, plane());
  for (int frame = 0; frame < 16; ++frame) {
    fly(bench, frame, .03);
    frame == 0 ? bench.render(accumulate("vec3(30. + x)", ""), options(64)) : bench.next_frame();
  }
  const Texels image = bench.read("image"), source = bench.read("source"), length = bench.read("length");
  double error = 0;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 50; ++x) {
      ASSERT_EQ(length.at(x, y).x, 16) << x << ' ' << y;
      for (int c = 0; c < 3; c += 2)
        error = std::max(error, std::abs(static_cast<double>(image.at(x, y)[c] - source.at(x, y)[c])));
    }
  }
  // A pixel of the floor is .1 m wide at most here; without following the camera the mean would lag .2 m behind.
  EXPECT_LT(error, .005);
}

// An orthographic camera that moves by whole pixels reads whole texels: what is carried along is exact.
TEST_F(AccumulateTest, AnOrthographicCameraIsFollowedToo) {
  Bench bench(*device_, plane());
  scene::Camera camera{.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}};
  camera.orthographic = true;
  camera.xmag = camera.ymag = 1;
  camera.znear = .01;
  for (int frame = 0; frame < 8; ++frame) {
    bench.look(camera);
    frame == 0 ? bench.render(accumulate("vec3(30. + x)", ""), options(32)) : bench.next_frame();
    camera.eye.x = camera.target.x = (frame + 1) * 2. / 32;
  }
  const Texels image = bench.read("image"), source = bench.read("source"), length = bench.read("length");
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      // One column of new floor comes in from the right with each frame.
      ASSERT_NEAR(length.at(x, y).x, std::min(8, 32 - x), 1e-3) << x << ' ' << y;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(image.at(x, y)[c], source.at(x, y)[c], 1e-4) << x << ' ' << y;
    }
  }
}

TEST_F(AccumulateTest, PoisonAndSharedStorageChangeNothing) {
  Bench bench(*device_, block());
  fly(bench, 0, 0);
  const auto after = [&](bool alias, bool poison) {
    BenchOptions how = options(32);
    how.frames = 4;
    how.alias = alias;
    how.poison = poison;
    bench.render(accumulate("uniform_noise", ""), how);
    return bench.read("image");
  };
  const Texels once = after(true, false);
  EXPECT_TRUE(after(false, false) == once);
  EXPECT_TRUE(after(true, true) == once);
}

// Samples of one pixel are of one surface: the mean goes on, and with it the mean over the pixel's area.
TEST_F(AccumulateTest, SubPixelShiftsDoNotMoveIt) {
  Bench bench(*device_, plane());
  bench.look({0, 3, 3}, {0, 0, 0}, .3);
  bench.render(accumulate("vec3(30. + x)", ""), options(32));
  const Texels centre = bench.read("source");
  bench.reset();
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) bench.next_frame({(x + .5) / 4 - .5, (y + .5) / 4 - .5});
  const Texels image = bench.read("image"), length = bench.read("length");
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    ASSERT_EQ(length.values[i].x, 16);
    ASSERT_NEAR(image.values[i].x, centre.values[i].x, 2e-3);
  }
}

TEST_F(AccumulateTest, AFrameThatIsNotFiniteLeavesTheMeanAsItIs) {
  Bench bench(*device_, plane());
  bench.look({0, 3, 3}, {0, 0, 0}, .3);
  BenchOptions how = options(16);
  how.frames = 7;
  bench.render(accumulate("frame.random.y % 3u == 0u ? vec3(0. / 0.) : vec3(.7)", ""), how);
  for (const glm::vec4& texel : bench.read("image").values) ASSERT_EQ(texel.x, .7F);
  EXPECT_EQ(bench.read("length").mean().x, 4);
}

}  // namespace
}  // namespace loom::test
