// FLIP against its definition, and its identities.
#include "measure/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/common.hpp>

#include "loom/diagnostic.h"
#include "measure/images.h"
#include "measure/naive_flip.h"

namespace loom::measure {
namespace {

using test::make_image;
using test::naive_flip;
using test::noise;
using test::uniform;
using test::view;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

glm::vec3 speckle(int x, int y) { return {noise(x, y, 0), noise(x, y, 1), noise(x, y, 2)}; }

/// Shapes, gradients and noise: something for every filter.
glm::vec3 scene(int x, int y) {
  const bool disc = (x - 12) * (x - 12) + (y - 9) * (y - 9) < 30;
  return disc ? glm::vec3(.9f, .2f, .1f) : .5f * glm::vec3(static_cast<float>(x) / 40, static_cast<float>(y) / 30, .5f);
}
glm::vec3 scene_with_errors(int x, int y) { return glm::min(scene(x + 1, y) + .15f * speckle(x, y), glm::vec3(1)); }

/// float against double; the square root in the feature term turns a rounding of 1e-8 into 1e-4 of an exponent.
constexpr double rounding = 1e-4;

void expect_map(const FlipMap& map, const std::vector<double>& expected) {
  ASSERT_EQ(map.error.size(), expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(map.error[i]) - expected[i]));
  }
  EXPECT_LT(worst, rounding);
}

TEST(Flip, IsItsDefinition) {
  for (const auto& [width, height] : {std::pair{41, 23}, {5, 3}, {1, 1}, {1, 40}, {40, 1}}) {
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    const ImageLayers a = make_image(width, height, scene_with_errors), r = make_image(width, height, scene);
    expect_map(flip_ldr(view(a), view(r)), naive_flip(a, r, default_pixels_per_degree));
  }
}

TEST(Flip, IsItsDefinitionAtOtherDistances) {
  const ImageLayers a = make_image(30, 20, scene_with_errors), r = make_image(30, 20, scene);
  for (const double ppd : {20., 100.}) expect_map(flip_ldr(view(a), view(r), ppd), naive_flip(a, r, ppd));
}

TEST(Flip, HdrIsTheWorstOfItsExposures) {
  const auto bright = [](int x, int y) { return std::exp2(static_cast<float>(x) / 6.f - 3.f) * scene(x, y); };
  const ImageLayers r = make_image(33, 17, bright);
  const ImageLayers a = make_image(33, 17, [&](int x, int y) { return bright(x, y) * (.7f + .6f * speckle(x, y)); });
  const FlipMap map = flip_hdr(view(a), view(r));
  ASSERT_TRUE(map.exposures);
  const Exposures e = *map.exposures;
  EXPECT_EQ(e.count, std::max(2, static_cast<int>(std::ceil(e.stop - e.start))));
  std::vector<double> worst(map.error.size(), 0);
  for (int i = 0; i < e.count; ++i) {
    const double exposure = e.start + i * (e.stop - e.start) / (e.count - 1);
    const auto shown = [&](ImageLayers image) {
      for (auto& [name, values] : image.channels) {
        for (float& v : values) v = static_cast<float>(test::naive_aces(static_cast<double>(v), exposure));
      }
      return image;
    };
    const std::vector<double> error = naive_flip(shown(a), shown(r), default_pixels_per_degree);
    for (std::size_t p = 0; p < error.size(); ++p) worst[p] = std::max(worst[p], error[p]);
  }
  expect_map(map, worst);
}

TEST(Flip, ExposuresBringTheBrightestAndTheMedianTo85Percent) {
  // Grey of luminance 1 … 9: brightest 9, median 5.
  const ImageLayers r = make_image(3, 3, [](int x, int y) { return glm::vec3(static_cast<float>(3 * y + x + 1)); });
  const Exposures e = automatic_exposures(view(r));
  EXPECT_NEAR(test::naive_aces(9, e.start), .85, 1e-6);
  EXPECT_NEAR(test::naive_aces(5, e.stop), .85, 1e-6);
  EXPECT_EQ(e.count, 2);
}

TEST(Flip, IdenticalImagesDoNotDiffer) {
  for (const auto& [width, height] : {std::pair{97, 61}, {1, 1}, {2, 9}}) {
    const ImageLayers image = make_image(width, height, [](int x, int y) { return 8.f * speckle(x, y); });
    for (const FlipMap& map : {flip_ldr(view(image), view(image)), flip_hdr(view(image), view(image))}) {
      EXPECT_EQ(map.mean, 0);
      EXPECT_EQ(*std::max_element(map.error.begin(), map.error.end()), 0);
    }
  }
}

TEST(Flip, UniformColoursDifferByTheirColourAlone) {
  const std::vector<glm::vec3> colors = {{0, 0, 0}, {1, 1, 1},        {1, 0, 0},      {0, 1, 0},
                                         {0, 0, 1}, {.2f, .2f, .21f}, {.5f, .1f, .3f}};
  for (const glm::vec3& a : colors) {
    for (const glm::vec3& r : colors) {
      const double mean = flip_ldr(view(uniform(6, 5, a)), view(uniform(6, 5, r))).mean;
      EXPECT_NEAR(mean, test::naive_flip_of_colors(a, r), rounding);
    }
  }
  EXPECT_NEAR(flip_ldr(view(uniform(6, 5, {0, 1, 0})), view(uniform(6, 5, {0, 0, 1}))).mean, 1, rounding)
      << "green and blue are the farthest apart";
}

TEST(Flip, LdrIsSymmetric) {
  const ImageLayers a = make_image(30, 20, scene_with_errors), r = make_image(30, 20, scene);
  EXPECT_EQ(flip_ldr(view(a), view(r)).error, flip_ldr(view(r), view(a)).error);
}

TEST(Flip, AMirroredPairHasTheMirroredMap) {
  const int width = 31, height = 14;
  const auto map_of = [&](bool mirrored) {
    const auto at = [&](int x) { return mirrored ? width - 1 - x : x; };
    const ImageLayers a = make_image(width, height, [&](int x, int y) { return scene_with_errors(at(x), y); });
    const ImageLayers r = make_image(width, height, [&](int x, int y) { return scene(at(x), y); });
    return flip_ldr(view(a), view(r)).error;
  };
  const std::vector<float> plain = map_of(false), mirrored = map_of(true);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      EXPECT_NEAR(plain[static_cast<std::size_t>(y * width + x)],
                  mirrored[static_cast<std::size_t>(y * width + width - 1 - x)], rounding);
    }
  }
}

TEST(Flip, HdrDoesNotDependOnTheUnit) {
  const ImageLayers r = make_image(25, 19, scene), a = make_image(25, 19, scene_with_errors);
  const auto scaled = [](ImageLayers image, float k) {
    for (auto& [name, values] : image.channels) {
      for (float& v : values) v *= k;
    }
    return image;
  };
  const FlipMap plain = flip_hdr(view(a), view(r));
  for (const int stops : {-14, 60, 100}) {
    const auto k = static_cast<float>(std::exp2(stops));
    const FlipMap map = flip_hdr(view(scaled(a, k)), view(scaled(r, k)));
    EXPECT_NEAR(map.exposures->start, plain.exposures->start - stops, 1e-5);
    EXPECT_EQ(map.exposures->count, plain.exposures->count);
    for (std::size_t i = 0; i < map.error.size(); ++i) EXPECT_NEAR(map.error[i], plain.error[i], rounding);
  }
}

TEST(Flip, HdrSeesTheErrorThatLdrClamps) {
  const ImageLayers r = uniform(8, 8, glm::vec3(50)), a = uniform(8, 8, glm::vec3(100));
  EXPECT_EQ(flip_ldr(view(a), view(r)).mean, 0);
  EXPECT_GT(flip_hdr(view(a), view(r)).mean, .01);
}

TEST(Flip, AnyFiniteValuesGiveAMapIn0To1) {
  constexpr float most = std::numeric_limits<float>::max();
  const std::vector<glm::vec3> colors = {glm::vec3(0),     glm::vec3(most),
                                         glm::vec3(-most), glm::vec3(1e-38f),
                                         {-1, 1e6f, 0},    glm::vec3(std::numeric_limits<float>::denorm_min())};
  for (const glm::vec3& a : colors) {
    for (const glm::vec3& r : colors) {
      const ImageLayers mixed = make_image(9, 5, [&](int x, int) { return x < 6 ? r : glm::vec3(.5f); });
      for (const FlipMap& map :
           {flip_ldr(view(uniform(9, 5, a)), view(mixed)), flip_hdr(view(uniform(9, 5, a)), view(mixed)),
            flip_hdr(view(uniform(9, 5, a)), view(uniform(9, 5, r)))}) {
        for (const float e : map.error) EXPECT_TRUE(e >= 0 && e <= 1) << e;
      }
    }
  }
}

TEST(Flip, NegativeLightIsSeenAsBlack) {
  const ImageLayers r = make_image(8, 8, scene);
  EXPECT_EQ(flip_hdr(view(uniform(8, 8, glm::vec3(-5))), view(r)).error,
            flip_hdr(view(uniform(8, 8, glm::vec3(0))), view(r)).error);
}

TEST(Flip, APixelThatIsNotFiniteIsWrongAndSpoilsNoOther) {
  const ImageLayers r = make_image(30, 20, scene);
  ImageLayers a = r;
  a.channels["G"][95] = nan;
  a.channels["R"][200] = std::numeric_limits<float>::infinity();
  for (const FlipMap& map : {flip_ldr(view(a), view(r)), flip_hdr(view(a), view(r))}) {
    for (std::size_t i = 0; i < map.error.size(); ++i) EXPECT_EQ(map.error[i], i == 95 || i == 200 ? 1 : 0);
  }
}

TEST(Flip, WhatCannotBeComparedIsRefused) {
  const ImageLayers image = uniform(4, 3, glm::vec3(1)), other = uniform(3, 4, glm::vec3(1));
  ImageLayers holed = image;
  holed.channels["B"][3] = nan;
  EXPECT_THROW(flip_ldr(view(image), view(other)), BadInput);
  EXPECT_THROW(flip_hdr(view(image), view(holed)), BadInput);
  EXPECT_THROW(flip_ldr(view(image), view(image), 0), BadInput);
  EXPECT_THROW(flip_ldr(view(image), view(image), static_cast<double>(nan)), BadInput);
  Layer two = view(image);
  two.planes.pop_back();
  EXPECT_THROW(flip_ldr(two, two), BadInput);
}

}  // namespace
}  // namespace loom::measure
