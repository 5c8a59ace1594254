// The search on a grid that was measured as a whole: does it find what is to be found, and in how many measurements?
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measure/sweep/result.h"
#include "measure/tune/gaussian_process.h"
#include "measure/tune/search.h"
#include "measure/tune/space.h"

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

/// Every setting of full.json on the box with the lamp, as `loom measure` recorded it; the file says how.
class Recorded : public testing::Test {
 protected:
  void SetUp() override {
    std::ifstream in(LOOM_SOURCE_DIR "/tests/tune/recorded.json");
    const auto recorded = nlohmann::ordered_json::parse(in);
    for (const auto& point : recorded["points"]) {
      Result result{.pipeline = point["pipeline"]};
      for (const auto& [knob, value] : point["set"].items()) result.set.emplace_back(knob, value.dump());
      grid_.push_back({.time_ms = point["cpu_ms"], .error = point["hdr_relmse"]});
      results_.push_back(std::move(result));
    }
    candidates_ = candidates_of(results_);
  }

  [[nodiscard]] Search tune(const Promise& promise, std::size_t evaluations) const {
    Search found;
    std::size_t measured = 0;
    search(
        candidates_, promise, evaluations,
        [&](std::size_t i) {
          ++measured;
          return grid_[i];
        },
        found);
    EXPECT_LE(measured, evaluations);
    EXPECT_EQ(found.seen.size(), measured) << "nothing is measured twice";
    return found;
  }
  /// The least value of all settings that keep the promise.
  [[nodiscard]] double truth(const Promise& promise) const {
    double best = std::numeric_limits<double>::infinity();
    for (const Observation& o : grid_) {
      if (promise.kept(o)) best = std::min(best, promise.value(o));
    }
    return best;
  }

  std::vector<Observation> grid_;
  std::vector<Result> results_;
  std::vector<Candidate> candidates_;
};

TEST_F(Recorded, TheFastestThatIsAccurateEnoughIsFoundInATenthOfTheMeasurements) {
  ASSERT_GT(grid_.size(), 150u);
  for (const double error : {.05, .02, .012, .01, .008, .006, .005, .004, .0035}) {
    const Promise promise{.max_error = error, .budget_ms = {}};
    const Search found = tune(promise, grid_.size() / 10);
    ASSERT_TRUE(found.best) << error;
    EXPECT_LE(grid_[*found.best].error, error);
    EXPECT_LE(grid_[*found.best].time_ms, 1.1 * truth(promise)) << error;
  }
}

TEST_F(Recorded, WhatNothingKeepsIsSaidWithTheNearest) {
  const Search found = tune({.max_error = 1e-6, .budget_ms = {}}, grid_.size() / 10);
  EXPECT_FALSE(found.best);
  ASSERT_TRUE(found.nearest);
  double least = std::numeric_limits<double>::infinity();
  for (const Observation& o : grid_) least = std::min(least, o.error);
  EXPECT_LE(grid_[*found.nearest].error, 1.3 * least);
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
