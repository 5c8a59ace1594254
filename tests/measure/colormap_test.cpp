#include "measure/colormap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "core/image_io.h"
#include "support/temp_dir.h"

namespace loom::measure {
namespace {

TEST(Magma, RunsFromBlackToPaleYellow) {
  EXPECT_LT(glm::length(magma(0) - glm::vec3(0, 0, 4) / 255.f), 1e-6f);
  EXPECT_LT(glm::length(magma(1) - glm::vec3(252, 253, 191) / 255.f), 1e-6f);
  EXPECT_EQ(magma(-1), magma(0));
  EXPECT_EQ(magma(7), magma(1));
  EXPECT_EQ(magma(std::numeric_limits<float>::quiet_NaN()), magma(1));
}

TEST(Magma, GetsLighterAllTheWay) {
  // Luma of the encoded values: more error reads as lighter on a grey print too. The table is rounded to 8 bits, which
  // may take half a step from each of two neighbours.
  constexpr float rounding = 1.f / 255.f;
  const auto luma = [](glm::vec3 c) { return .2126f * c.r + .7152f * c.g + .0722f * c.b; };
  for (int i = 1; i < 256; ++i) {
    EXPECT_GE(luma(magma(static_cast<float>(i) / 255.f)), luma(magma(static_cast<float>(i - 1) / 255.f)) - rounding);
  }
}

TEST(Heatmap, HoldsTheColourOfEachPixel) {
  const test::TempDir dir;
  const std::vector<float> error = {0, .25f, .5f, .75f, 1, .1f};
  write_heatmap(dir / "heat.png", 3, 2, error);
  const ImageLayers image = read_png(dir / "heat.png");
  ASSERT_EQ(image.width, 3);
  ASSERT_EQ(image.height, 2);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const float linear = image.channels.at("R")[i];
    const float encoded = linear <= .0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - .055f;
    EXPECT_NEAR(encoded, magma(error[i]).r, 1e-4f);
  }
}

}  // namespace
}  // namespace loom::measure
