// What is made of measurements: intervals, fronts, knobs, flicker.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "measure/bootstrap.h"
#include "measure/flicker.h"
#include "measure/report/front.h"
#include "measure/report/report.h"
#include "measure/sweep/result.h"

namespace loom::measure {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

TEST(Bootstrap, CoversTheTrueMeanAsOftenAsItSays) {
  // Pixels of one block err alike, as they do in pictures; blocks are independent. 64 values of unit deviation.
  std::mt19937 random(7);
  std::normal_distribution<double> normal(3, 1);
  int covered = 0;
  constexpr int trials = 300;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> values(32 * 32);
    for (int block = 0; block < 64; ++block) {
      const double value = normal(random);
      for (int i = 0; i < 16; ++i) {
        const int y = block / 8 * 4 + i / 4, x = block % 8 * 4 + i % 4;
        values[static_cast<std::size_t>(y * 32 + x)] = value;
      }
    }
    const Interval interval = block_bootstrap(values, 32, 32);
    covered += interval.low <= 3 && 3 <= interval.high ? 1 : 0;
    EXPECT_NEAR(interval.high - interval.low, 2 * 1.96 / 8, .2);
  }
  // 95 % of 300 with a binomial deviation of 3.8, and a little less since percentile intervals are narrow.
  EXPECT_GT(covered, 300 * .95 - 4 * 3.8 - 3);
}

TEST(Bootstrap, LeavesOutWhatIsNoNumber) {
  const Interval interval = block_bootstrap({1, none, 1, 1}, 2, 2);
  EXPECT_EQ(interval.low, 1);
  EXPECT_EQ(interval.high, 1);
  EXPECT_TRUE(std::isnan(block_bootstrap({none}, 1, 1).low));
}

TEST(Front, HoldsWhatNothingElseBeats) {
  EXPECT_THAT(pareto_front({1, 2, 2, 3, 4, none, 5}, {9, 5, 5, 6, 1, 0, none}),
              ElementsAre(true, true, true, false, true, false, false));
  EXPECT_THAT(pareto_front({1, 1}, {2, 3}), ElementsAre(true, false));
}

TEST(Front, RoundSteps) {
  EXPECT_THAT(round_steps(.0015, .02), ElementsAre(.002, .005, .01, .02));
  EXPECT_THAT(round_steps(7, 100), ElementsAre(10, 20, 50, 100));
  EXPECT_THAT(round_steps(0, 1), IsEmpty());
}

Result point(int iterations, int grid, double error, double sd) {
  Result r{.key = std::to_string(iterations) + "-" + std::to_string(grid), .scene = "s", .pipeline = "p"};
  r.set = {{"lpv.iterations", std::to_string(iterations)}, {"inject.grid", std::to_string(grid)}};
  r.errors["hdr"] = {.relmse = error, .low = error, .high = error, .seed_sd = sd};
  return r;
}

TEST(Knobs, AreOddWhereMoreIsBetterAndThenWorse) {
  // Along iterations with grid 4 the error turns back by more than the seeds scatter, with grid 8 by less.
  const std::vector<OddKnob> odd = odd_knobs({point(16, 4, .3, .001), point(4, 4, .4, .001), point(8, 4, .1, .001),  //
                                              point(4, 8, .4, .05), point(8, 8, .1, .05), point(16, 8, .2, .05)});
  ASSERT_EQ(odd.size(), 1u);
  EXPECT_EQ(odd[0].param, "lpv.iterations");
  EXPECT_EQ(odd[0].with, "inject.grid=4");
  EXPECT_THAT(odd[0].values, ElementsAre("4", "8", "16"));
  EXPECT_THAT(odd_knobs({point(4, 4, .4, 0), point(8, 4, .2, 0), point(16, 4, .1, 0)}), IsEmpty());
}

TEST(Reference, IsRefusedWhereItIsNotTenTimesBetterThanTheBestMethod) {
  const Sweep sweep;
  ReportData data{.folder = {}, .sweep = sweep};
  data.results = {point(4, 4, 1e-2, 0), point(8, 4, 2e-3, 0)};
  data.results[0].truth = data.results[1].truth = "id";
  SceneReport scene{.name = "s", .truth = "id", .spp = 1024, .noise = 1.9e-4};
  data.scenes = {scene};
  EXPECT_THAT(refused_truths(data), IsEmpty());
  data.scenes[0].noise = 4e-4;
  const std::vector<RefusedTruth> refused = refused_truths(data);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].enough_spp, 2560u) << "twice as many, and a quarter more";
}

TEST(Flicker, IsWhatIsLeftOfASlowChange) {
  std::vector<double> smooth, noisy;
  for (int i = 0; i < 12; ++i) {
    smooth.push_back(1 + .1 * i - .004 * i * i);
    noisy.push_back(2 + (i % 2 == 0 ? .02 : -.02));
  }
  EXPECT_NEAR(flicker(smooth), 0, 1e-12);
  EXPECT_NEAR(flicker(noisy), .01, 2e-4);
}

TEST(Results, SurviveTheirFile) {
  Result r = point(4, 8, .25, .01);
  r.size = {64, 32};
  r.set.emplace_back("lpv.blockers", "\"sh\"");
  r.wall_ms = {12.5, 13};
  r.bytes = 12345;
  r.flicker = .5;
  r.device = "a device";
  const Result back = result_from(to_json(r), "file");
  EXPECT_EQ(to_json(back).dump(), to_json(r).dump());
  EXPECT_EQ(back.set, r.set);
  EXPECT_THROW(result_from(nlohmann::ordered_json::object(), "file"), BadInput);
}

}  // namespace
}  // namespace loom::measure
