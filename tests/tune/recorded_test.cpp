// The search on a grid that was measured as a whole: does it find what is to be found, and in how few measurements?
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "measure/sweep/result.h"
#include "measure/tune/search.h"
#include "measure/tune/space.h"

namespace loom::measure {
namespace {

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
  ASSERT_GT(grid_.size(), 400u);
  for (const double error : {.1, .05, .02, .015, .01, .009, .008, .007}) {
    const Promise promise{.max_error = error, .budget_ms = {}};
    const Search found = tune(promise, grid_.size() / 10);
    ASSERT_TRUE(found.best) << error;
    EXPECT_LE(grid_[*found.best].error, error);
    EXPECT_LE(grid_[*found.best].time_ms / truth(promise), 1.1) << error;
  }
}

TEST_F(Recorded, TheMostAccurateThatIsFastEnoughIsFoundInATenthOfTheMeasurements) {
  for (const double budget : {10., 20., 30., 40., 50., 60., 100.}) {
    const Promise promise{.max_error = {}, .budget_ms = budget};
    const Search found = tune(promise, grid_.size() / 10);
    ASSERT_TRUE(found.best) << budget;
    EXPECT_LE(grid_[*found.best].time_ms, budget);
    EXPECT_LE(grid_[*found.best].error / truth(promise), 1.1) << budget;
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

}  // namespace
}  // namespace loom::measure
