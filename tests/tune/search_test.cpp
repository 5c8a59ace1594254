// Regression by Gaussian process, and the search that is guided by it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "measure/tune/gaussian_process.h"
#include "measure/tune/search.h"

namespace loom::measure {
namespace {

TEST(GaussianProcess, GoesThroughWhatWasSeenAndDoubtsWhatIsFarFromIt) {
  const auto kernel = [](std::size_t i, std::size_t k) {
    const double d = static_cast<double>(i) - static_cast<double>(k);
    return 4 * std::exp(-d * d / 8);
  };
  const GaussianProcess process(kernel, {0, 4, 8}, {1, 3, 2}, 1e-4);
  EXPECT_NEAR(process.at(4).mean, 3, 1e-6);
  EXPECT_NEAR(process.at(4).sd, 0, 1e-3);
  EXPECT_GT(process.at(6).sd, process.at(5).sd);
  EXPECT_NEAR(process.at(100).mean, 2, 1e-9) << "the mean of what was seen";
  EXPECT_NEAR(process.at(100).sd, 2, 1e-9);
  // One observation in closed form: mean + k/(k0+n²)·deviation is the mean itself; variance k0 − k²/(k0+n²).
  EXPECT_NEAR(GaussianProcess(kernel, {0}, {7}, 1).at(2).sd, std::sqrt(4 - 16 * std::exp(-1.) / 5), 1e-12);
}

TEST(Search, TakesOverWhatIsKnownAndLeavesOutWhatFails) {
  const std::vector<Candidate> candidates = {{"a", {}}, {"b", {}}, {"c", {}}};
  Search found;
  found.seen[0] = {.time_ms = 5, .error = .1};
  std::vector<std::size_t> measured;
  search(
      candidates, {.max_error = .2, .budget_ms = {}}, 10,
      [&](std::size_t i) {
        measured.push_back(i);
        return Observation{.time_ms = 1, .error = i == 1 ? std::numeric_limits<double>::infinity() : .15};
      },
      found);
  EXPECT_THAT(measured, testing::UnorderedElementsAre(1, 2));
  EXPECT_EQ(found.best, 2u);
}

}  // namespace
}  // namespace loom::measure
