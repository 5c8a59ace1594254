// Every metric on images for which its value is known.
#include "measure/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "loom/diagnostic.h"
#include "measure/images.h"

namespace loom::measure {
namespace {

using test::make_image;
using test::noise;
using test::uniform;
using test::view;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

glm::vec3 speckle(int x, int y) { return {noise(x, y, 0), noise(x, y, 1), noise(x, y, 2)}; }

Layer single(const std::vector<float>& values) {
  return {.width = static_cast<int>(values.size()),
          .height = 1,
          .name = "depth",
          .channels = {"depth.Z"},
          .planes = {std::span<const float>(values)}};
}

TEST(Metrics, IdenticalImagesHaveNoError) {
  const ImageLayers image = make_image(13, 7, speckle);
  const Metrics m = compute_metrics(view(image), view(image));
  EXPECT_EQ(m.relmse, 0);
  EXPECT_EQ(m.rmse, 0);
  EXPECT_EQ(m.smape, 0);
  EXPECT_EQ(m.mean_ratio, 1);
  EXPECT_EQ(m.p99_abs, 0);
  EXPECT_EQ(m.non_finite, 0u);
  EXPECT_EQ(m.pixels, 91u);
}

TEST(Metrics, UniformErrorPerChannel) {
  const ImageLayers a = uniform(5, 4, {2, 0, 3});
  const ImageLayers r = uniform(5, 4, {1, 0, 5});
  const Metrics m = compute_metrics(view(a), view(r));
  EXPECT_NEAR(m.relmse, (1 / 1.01 + 0 + 4 / 25.01) / 3, 1e-15);
  EXPECT_NEAR(m.rmse, std::sqrt((1. + 0 + 4) / 3), 1e-15);
  EXPECT_NEAR(m.smape, (1 / 3.01 + 0 + 2 / 8.01) / 3, 1e-15);
  EXPECT_NEAR(m.mean_ratio, 5. / 6, 1e-15);
}

TEST(Metrics, MeanRatioIsTheFactorThatAnImageIsTooBrightBy) {
  const ImageLayers r = make_image(31, 17, speckle);
  const ImageLayers a = make_image(31, 17, [](int x, int y) { return 1.25f * speckle(x, y); });
  EXPECT_NEAR(compute_metrics(view(a), view(r)).mean_ratio, 1.25, 1e-7);
}

TEST(Metrics, MeanRatioIsBlindToErrorsThatCancel) {
  const ImageLayers r = uniform(2, 1, glm::vec3(1));
  const ImageLayers a = make_image(2, 1, [](int x, int) { return glm::vec3(x == 0 ? 4.f : -2.f); });
  const Metrics m = compute_metrics(view(a), view(r));
  EXPECT_EQ(m.mean_ratio, 1);
  EXPECT_NEAR(m.rmse, 3, 1e-15);
}

TEST(Metrics, PercentileIsLinearBetweenOrderStatistics) {
  std::vector<float> ramp(101), ten(10);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<float>(i * 37 % 101);  // 0 … 100, shuffled
  for (std::size_t i = 0; i < ten.size(); ++i) ten[i] = -static_cast<float>(i);
  EXPECT_NEAR(compute_metrics(single(ramp), single(std::vector<float>(101, 0))).p99_abs, 99, 1e-12);
  EXPECT_NEAR(compute_metrics(single(ten), single(std::vector<float>(10, 0))).p99_abs, 8.91, 1e-12);
  EXPECT_EQ(compute_metrics(single({3}), single({1})).p99_abs, 2);
}

TEST(Metrics, RmseAndSmapeAreSymmetricAndRelmseIsNot) {
  const ImageLayers a = make_image(9, 9, speckle);
  const ImageLayers r = make_image(9, 9, [](int x, int y) { return 2.f * speckle(y, x); });
  const Metrics forth = compute_metrics(view(a), view(r)), back = compute_metrics(view(r), view(a));
  EXPECT_EQ(forth.rmse, back.rmse);
  EXPECT_EQ(forth.smape, back.smape);
  EXPECT_EQ(forth.p99_abs, back.p99_abs);
  EXPECT_NE(forth.relmse, back.relmse);
}

TEST(Metrics, BlackReferenceLeavesFiniteErrorsAndNoRatio) {
  const ImageLayers a = uniform(3, 3, glm::vec3(.5f));
  const ImageLayers r = uniform(3, 3, glm::vec3(0));
  const Metrics m = compute_metrics(view(a), view(r));
  EXPECT_NEAR(m.relmse, .25 / 1e-2, 1e-12);
  EXPECT_NEAR(m.smape, .5 / .51, 1e-12);
  EXPECT_TRUE(std::isnan(m.mean_ratio));
}

TEST(Metrics, RangeOfAFloatDoesNotOverflow) {
  const float most = std::numeric_limits<float>::max();
  const ImageLayers a = uniform(2, 2, glm::vec3(most));
  const ImageLayers r = uniform(2, 2, glm::vec3(-most));
  const Metrics m = compute_metrics(view(a), view(r));
  EXPECT_NEAR(m.relmse, 4, 1e-12);
  EXPECT_NEAR(m.rmse / static_cast<double>(most), 2, 1e-12);
  EXPECT_NEAR(m.smape, 1, 1e-12);
  EXPECT_NEAR(m.p99_abs / static_cast<double>(most), 2, 1e-12);
  const ImageLayers tiny = uniform(2, 2, glm::vec3(std::numeric_limits<float>::denorm_min()));
  EXPECT_GT(compute_metrics(view(tiny), view(uniform(2, 2, glm::vec3(0)))).rmse, 0);
}

TEST(Metrics, NonFinitePixelsAreCountedAndLeftOutOfEveryMean) {
  ImageLayers a = make_image(6, 5, speckle);
  const ImageLayers r = make_image(6, 5, [](int x, int y) { return speckle(y, x); });
  std::vector<std::uint8_t> mask(30, 1);
  mask[7] = mask[20] = 0;
  const Metrics masked = compute_metrics(view(a), view(r), mask);
  a.channels["R"][7] = nan;
  a.channels["B"][7] = infinity;  // the same pixel: counted once
  a.channels["G"][20] = -infinity;
  const Metrics holed = compute_metrics(view(a), view(r));
  EXPECT_EQ(holed.non_finite, 2u);
  EXPECT_EQ(holed.pixels, 28u);
  EXPECT_EQ(holed.relmse, masked.relmse);
  EXPECT_EQ(holed.rmse, masked.rmse);
  EXPECT_EQ(holed.smape, masked.smape);
  EXPECT_EQ(holed.mean_ratio, masked.mean_ratio);
  EXPECT_EQ(holed.p99_abs, masked.p99_abs);
  EXPECT_EQ(masked.pixels, 28u);
  EXPECT_EQ(compute_metrics(view(a), view(r), mask).non_finite, 0u) << "outside the mask nothing counts";
}

TEST(Metrics, NoValidPixelGivesNoNumber) {
  const ImageLayers a = uniform(3, 2, glm::vec3(nan)), r = uniform(3, 2, glm::vec3(1));
  const Comparison c = compare(view(a), view(r), true);
  EXPECT_EQ(c.metrics.pixels, 0u);
  EXPECT_EQ(c.metrics.non_finite, 6u);
  ASSERT_TRUE(c.metrics.flip);
  for (const double v :
       {c.metrics.relmse, c.metrics.rmse, c.metrics.smape, *c.metrics.flip, c.metrics.mean_ratio, c.metrics.p99_abs}) {
    EXPECT_TRUE(std::isnan(v));
  }
}

TEST(Metrics, AReferenceThatIsNotFiniteIsRefusedWithItsFirstPixel) {
  const ImageLayers a = uniform(6, 5, glm::vec3(1));
  for (const float bad : {nan, infinity}) {
    ImageLayers r = a;
    r.channels["B"][8] = bad;
    r.channels["B"][9] = bad;
    const std::vector<std::uint8_t> mask(30, 0);
    for (const Mask m : {Mask(), Mask(mask)}) {
      try {
        compute_metrics(view(a), view(r), m);
        FAIL() << "accepted";
      } catch (const BadInput& error) {
        EXPECT_EQ(error.diagnostics().all().front().code, "reference-not-finite");
        EXPECT_THAT(error.what(), testing::HasSubstr("at pixel (2, 1) of channel B, which has 2 such values"));
      }
    }
  }
}

TEST(Metrics, ShapesMustAgree) {
  const ImageLayers a = uniform(6, 5, glm::vec3(1)), r = uniform(5, 6, glm::vec3(1));
  EXPECT_THROW(compute_metrics(view(a), view(r)), BadInput);
  EXPECT_THROW(compute_metrics(view(a), single(std::vector<float>(30, 1))), BadInput);
  const std::vector<std::uint8_t> mask(29, 1);
  EXPECT_THROW(compute_metrics(view(a), view(a), mask), BadInput);
}

TEST(Metrics, TheSameImagesGiveTheSameBits) {
  const ImageLayers a = make_image(97, 61, speckle);
  const ImageLayers r = make_image(97, 61, [](int x, int y) { return 3.f * speckle(y, x); });
  const Metrics once = compare(view(a), view(r), true).metrics, again = compare(view(a), view(r), true).metrics;
  EXPECT_EQ(once.relmse, again.relmse);
  EXPECT_EQ(once.rmse, again.rmse);
  EXPECT_EQ(once.smape, again.smape);
  EXPECT_EQ(once.flip, again.flip);
  EXPECT_EQ(once.mean_ratio, again.mean_ratio);
}

TEST(Comparison, FlipIsTheMeanOfItsMapOverTheValidPixels) {
  const ImageLayers a = make_image(16, 12, speckle), r = uniform(16, 12, glm::vec3(.5f));
  const Comparison all = compare(view(a), view(r), false);
  EXPECT_NEAR(*all.metrics.flip, all.flip->mean, 1e-12);
  std::vector<std::uint8_t> mask(192, 0);
  mask[17] = mask[90] = 1;
  const Comparison some = compare(view(a), view(r), false, mask);
  EXPECT_NEAR(*some.metrics.flip,
              .5 * (static_cast<double>(all.flip->error[17]) + static_cast<double>(all.flip->error[90])), 1e-12);
}

TEST(Comparison, WhatIsNoColourHasNoFlip) {
  EXPECT_FALSE(compare(single({1, 2}), single({1, 3}), true).metrics.flip);
  const ImageLayers image = uniform(2, 2, glm::vec3(0, 1, 0));
  Layer normal = view(image);
  normal.name = "normal";
  EXPECT_FALSE(compare(normal, normal, true).metrics.flip);
}

}  // namespace
}  // namespace loom::measure
