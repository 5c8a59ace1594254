// The points: stratified as a (0,2)-sequence is, uniform, independent between replicates.
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "reference/sampler.h"

namespace loom::reference {
namespace {

// Any 2^m points from the start: every elementary box of area 2^-m holds exactly one.
TEST(Sampler, EveryElementaryBoxHoldsOnePoint) {
  for (const std::uint32_t set : {0U, 7U}) {
    for (std::uint32_t m = 0; m <= 8; ++m) {
      for (std::uint32_t columns = 0; columns <= m; ++columns) {
        std::set<std::pair<int, int>> boxes;
        for (std::uint32_t i = 0; i < 1U << m; ++i) {
          const glm::vec2 p = PathSampler(3, 42, 5, i).pair(set);
          ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
          boxes.emplace(static_cast<int>(p.x * static_cast<float>(1U << columns)),
                        static_cast<int>(p.y * static_cast<float>(1U << (m - columns))));
        }
        EXPECT_EQ(boxes.size(), 1U << m) << "m " << m << ", columns 2^" << columns << ", set " << set;
      }
    }
  }
}

/// Correlation of the first points of many pixels between two choices of replicate, seed, set or coordinate.
template <class A, class B>
double correlation(A&& a, B&& b) {
  constexpr int n = 20000;
  double sum = 0;
  for (std::uint64_t pixel = 0; pixel < n; ++pixel) sum += (a(pixel) - .5) * (b(pixel) - .5);
  return 12 * sum / n;
}

TEST(Sampler, PixelsReplicatesSeedsSetsAndCoordinatesAreUncorrelated) {
  const auto first = [](std::uint64_t seed, std::uint32_t replicate, std::uint32_t set, int axis, int shift) {
    return [=](std::uint64_t pixel) {
      return static_cast<double>(
          PathSampler(seed, pixel + static_cast<std::uint64_t>(shift), replicate, 0).pair(set)[axis]);
    };
  };
  const auto base = first(1, 0, 0, 0, 0);
  const double bound = 5 / std::sqrt(20000.);  // five standard deviations
  EXPECT_NEAR(correlation(base, base), 1, bound);
  EXPECT_LT(std::abs(correlation(base, first(1, 1, 0, 0, 0))), bound);
  EXPECT_LT(std::abs(correlation(base, first(2, 0, 0, 0, 0))), bound);
  EXPECT_LT(std::abs(correlation(base, first(1, 0, 1, 0, 0))), bound);
  EXPECT_LT(std::abs(correlation(base, first(1, 0, 0, 1, 0))), bound);
  EXPECT_LT(std::abs(correlation(base, first(1, 0, 0, 0, 1))), bound);
}

}  // namespace
}  // namespace loom::reference
