// Each rule by itself: its threshold, and that its bound holds where it is tight.
#include <climits>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "loom/facts.h"
#include "loom/rules.h"
#include "scene/load.h"
#include "support/bench.h"

namespace loom::test {
namespace {

Ports all_rules() { return {{1, 1}, {}}; }
Ports without(std::string_view rule) {
  return {{1, 1}, {}, [rule](std::string_view name) { return name != rule; }};
}

TEST(Rules, OneChannelUpToTheThreshold) {
  SceneFacts facts;
  EXPECT_EQ(rules::channels(all_rules(), facts), 1);
  EXPECT_EQ(rules::channels(without("achromatic"), facts), 3);
  facts.max_chroma = rules::achromatic_threshold;
  EXPECT_EQ(rules::channels(all_rules(), facts), 1);
  facts.max_chroma *= 1.001;
  EXPECT_EQ(rules::channels(all_rules(), facts), 3);
}

TEST(Rules, AsManyChannelsAsTheWidestInput) {
  BundleInfo one{.type = "Irradiance"}, three{.type = "Irradiance"}, unknown{.type = "Irradiance"}, none = three;
  one.attributes["channels"] = 1;
  three.attributes["channels"] = 3;
  none.absent = "nothing";
  Ports ports({1, 1}, {{"one", one}, {"three", three}, {"unknown", unknown}, {"none", none}});
  const auto in = [&](const char* name) { return ports.in(name, "Irradiance"); };
  EXPECT_EQ(rules::channels({in("one"), in("none")}), 1);
  EXPECT_EQ(rules::channels({in("one"), in("three")}), 3);
  EXPECT_EQ(rules::channels({in("one"), in("unknown")}), 3) << "a program's own texture may be coloured";
}

TEST(Rules, BouncesFromTheLargestAlbedo) {
  const auto needed = [](double albedo) { return rules::bounces(all_rules(), albedo); };
  for (const double albedo : {.02, .1, .3, .5, .73, .9, .99}) {
    const int n = needed(albedo);
    EXPECT_LT(std::pow(albedo, n + 1), rules::bounces_threshold) << albedo;
    EXPECT_TRUE(n == 1 || std::pow(albedo, n) >= rules::bounces_threshold) << albedo;
  }
  EXPECT_EQ(needed(0), 1);
  EXPECT_EQ(needed(1), INT_MAX);
  EXPECT_EQ(rules::bounces(without("bounces"), 0), INT_MAX);

  Ports ports = all_rules();
  rules::decide_bounces(ports, 1, 8);
  ASSERT_EQ(ports.decisions.size(), 1u);
  EXPECT_NE(ports.decisions[0].decision.find("capped at 8"), std::string::npos) << ports.decisions[0].decision;
}

TEST(Rules, IterationsAreTwiceTheSquareOfTheWay) {
  EXPECT_EQ(rules::iterations(all_rules(), 3), 18);
  EXPECT_EQ(rules::iterations(all_rules(), 0), 1);
  EXPECT_EQ(rules::iterations(without("iterations"), 3), INT_MAX);
  Ports ports = all_rules();
  rules::decide_iterations(ports, 30, 16);
  ASSERT_EQ(ports.decisions.size(), 1u);
  EXPECT_NE(ports.decisions[0].evidence.find("cascade"), std::string::npos) << ports.decisions[0].evidence;
}

TEST(Rules, BandsByWhatIrradianceLoses) {
  SceneFacts facts;
  Ports ports = all_rules();
  EXPECT_EQ(rules::bands(ports, facts, 2), 2) << "not measured";
  facts.measured.emplace().probes = 1;
  facts.measured->radiance = {.9, .1};
  EXPECT_EQ(rules::bands(ports, facts, 2), 1);
  facts.measured->radiance = {1};
  EXPECT_EQ(rules::bands(ports, facts, 2), 0);
  // Band 2 of radiance counts A₂²/A₀² = 1/16 in irradiance.
  facts.measured->radiance = {.97, 0, .03};
  EXPECT_NEAR(rules::above_band(*facts.measured, 1), .03 / 16 / (.97 + .03 / 16), 1e-12);
  EXPECT_EQ(rules::bands(ports, facts, 4), 2);
  Ports off = without("bands");
  EXPECT_EQ(rules::bands(off, facts, 4), 4);
}

TEST(Rules, TheLitBoxWhereItIsSmallAndStill) {
  SceneFacts facts;
  facts.bounds_max = glm::dvec3(10);
  facts.measured.emplace().lit_max = glm::dvec3(2);
  EXPECT_EQ(rules::bounds(all_rules(), facts).high, glm::dvec3(2));
  EXPECT_EQ(rules::bounds(without("bounds"), facts).high, glm::dvec3(10));
  facts.measured->lit_max = glm::dvec3(9);
  EXPECT_EQ(rules::bounds(all_rules(), facts).high, glm::dvec3(10)) << "little would be gained";
  facts.measured->lit_max = glm::dvec3(2);
  facts.moves = true;
  EXPECT_EQ(rules::bounds(all_rules(), facts).high, glm::dvec3(10));
}

class RuleBounds : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// Colours as far apart as the rule allows, light and walls alike: channels drift by at most (n+2)·2⁻¹¹.
TEST_F(RuleBounds, AlmostGreyStaysWithinTheProof) {
  const auto tinted = [](float value) {
    const float low = value * static_cast<float>(1 - rules::achromatic_threshold);
    return glm::vec3(value, low, low);
  };
  SceneBuilder builder;
  const int wall = builder.material(tinted(.5f));
  builder.floor({0, 0, 0}, 1, wall).box({-.5f, 0, -.5f}, {0, .8f, 0}, wall);
  Bench bench(*device_, builder.spot({.2f, 1.9f, .1f}, {-.1f, -1, -.2f}, tinted(6), .4, .7).build());
  bench.look({0, 1, 3.2}, {0, .5, 0}, .4);
  BenchOptions options{.size = {24, 20}, .set = {{"rsm", "size", "16"}, {"rsm", "shadow_size", "128"}}};
  const Texels pruned = bench.image("lpv-fast.json", "hdr", options);
  ASSERT_LE(bench.facts().max_chroma, rules::achromatic_threshold * 1.0001);
  ASSERT_EQ(bench.renderer().output("hdr")->desc().format, Format::r32f);
  options.disabled_rules = {"achromatic"};
  const Texels full = bench.image("lpv-fast.json", "hdr", options);
  const double bound = (3 + 2) * rules::achromatic_threshold;  // lpv-fast counts three reflections
  double most = 0;
  for (std::size_t i = 0; i < full.values.size(); ++i) {
    EXPECT_EQ(pruned.values[i].r, full.values[i].r) << "red goes the same way";
    for (int c = 1; c < 3; ++c) {
      if (!(full.values[i][c] > 0)) continue;
      const double off = std::abs(pruned.values[i][c] / full.values[i][c] - 1);
      EXPECT_LE(off, bound);
      most = std::max(most, off);
    }
  }
  EXPECT_GT(most, rules::achromatic_threshold) << "the scene is no test of the bound";
}

}  // namespace
}  // namespace loom::test
