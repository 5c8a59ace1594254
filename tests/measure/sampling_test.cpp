// Sub-pixel samples and their mean.
#include "measure/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/srgb.h"

namespace loom::measure {
namespace {

TEST(Jitter, OneSampleIsTheCentre) {
  ASSERT_EQ(jitter(1).size(), 1u);
  EXPECT_EQ(jitter(1)[0], glm::dvec2(0));
}

TEST(Jitter, EveryCountTakesEachColumnAndRowOnceAndAveragesToTheCentre) {
  for (const int n : {2, 3, 4, 7, 16, 100, 1000}) {
    std::set<int> columns;
    std::set<int> rows;
    glm::dvec2 sum(0);
    for (const glm::dvec2& offset : jitter(n)) {
      EXPECT_GE(offset.x, -.5);
      EXPECT_LT(offset.x, .5);
      columns.insert(static_cast<int>((offset.x + .5) * n));
      rows.insert(static_cast<int>((offset.y + .5) * n));
      sum += offset;
    }
    EXPECT_EQ(columns.size(), static_cast<std::size_t>(n));
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(n));
    EXPECT_NEAR(sum.x, 0, 1e-9);
    EXPECT_NEAR(sum.y, 0, 1e-9);
  }
}

TEST(Jitter, SixteenSamplesTakeEachCellOfAFourByFourGridOnce) {
  std::set<int> cells;
  for (const glm::dvec2& offset : jitter(16)) {
    cells.insert(4 * static_cast<int>(4 * (offset.y + .5)) + static_cast<int>(4 * (offset.x + .5)));
  }
  EXPECT_EQ(cells.size(), 16u);
}

graph::ReadImage pixel(float value, const std::string& quantity) {
  graph::ReadImage image{.width = 1, .height = 1, .layers = 1, .texels = {glm::vec4(value, value, value, 1)}};
  image.quantity = quantity;
  return image;
}

TEST(SampleMean, RadianceIsAveragedAsItIs) {
  Mean mean;
  mean.add(pixel(1, "radiance"));
  mean.add(pixel(4, "radiance"));
  EXPECT_FLOAT_EQ(mean.image().texels[0].r, 2.5f);
  EXPECT_EQ(mean.image().quantity, "radiance");
}

TEST(SampleMean, DisplayValuesAreAveragedAsLight) {
  Mean mean;
  mean.add(pixel(0, "display"));
  mean.add(pixel(1, "display"));
  EXPECT_FLOAT_EQ(mean.image().texels[0].r, linear_to_srgb(.5f));  // .735, not .5
}

}  // namespace
}  // namespace loom::measure
