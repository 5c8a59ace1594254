// The quick part of the stress cases: ends of every parameter that there is, odd scenes, one pixel, and the laws of
// light with the precision that is reached. What is tried comes from the pipelines and the declarations of their
// passes; `loom stress` has the rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "measure/stress.h"
#include "measure/stress_cover.h"
#include "measure/stress_scenes.h"
#include "scene/load.h"
#include "support/bench.h"
#include "support/gl.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

// Most of the time goes into compiling programs that draw a few pixels.
[[maybe_unused]] const int unoptimised = setenv("GALLIVM_PERF", "nopt", 0);

using measure::StressCase;
using measure::StressOutcome;

std::vector<std::string> pipelines() {
  std::vector<std::string> list;
  for (const auto& entry : fs::directory_iterator(LOOM_SOURCE_DIR "/pipelines")) {
    if (entry.path().extension() == ".json") list.push_back(entry.path().string());
  }
  std::sort(list.begin(), list.end());
  return list;
}

/// What takes more is slow too; `loom stress` tries it.
constexpr measure::StressLimits quick{.bytes = std::size_t{48} << 20};

class Extremes : public GlTest {
 protected:
  /// Runs the quick cases whose group is, or is not, about parameters.
  void run(bool parameters) {
    const auto device = make_device();
    std::size_t held = 0, refused = 0, skipped = 0;
    for (const StressCase& c : measure::stress_cases(pipelines(), all_passes())) {
      if (!c.quick || (c.group == measure::parameters_group) != parameters) continue;
      const measure::StressResult result = run_stress(c, all_passes(), *device, quick);
      EXPECT_NE(result.outcome, StressOutcome::broken) << c.id() << ": " << result.message;
      held += result.outcome == StressOutcome::held ? 1 : 0;
      refused += result.outcome == StressOutcome::refused ? 1 : 0;
      skipped += result.outcome == StressOutcome::skipped ? 1 : 0;
      if (std::isfinite(c.tolerance)) {
        std::printf("  %-60s off by %.1e, %.0e allowed\n", c.id().c_str(), result.error, c.tolerance);
      }
    }
    std::printf("  %zu held, %zu were refused before the first frame, %zu take more memory\n", held, refused, skipped);
    EXPECT_GT(held, 10 * (refused + skipped));
  }
};

TEST_F(Extremes, EveryParameterAtBothEnds) { run(true); }
TEST_F(Extremes, OddScenesAndTheLawsOfLight) { run(false); }

TEST(Cover, EveryTwoValuesMeet) {
  const std::vector<int> counts{2, 3, 1, 4, 2, 2, 3, 2, 2, 2};
  std::set<std::vector<int>> met;
  const auto rows = measure::pairwise_cover(counts, 1, [](const measure::ValuePair&) { return true; });
  for (const std::vector<int>& row : rows) {
    for (int a = 0; a < 10; ++a) {
      ASSERT_LT(row[static_cast<std::size_t>(a)], counts[static_cast<std::size_t>(a)]);
      for (int b = a + 1; b < 10; ++b) {
        met.insert({a, row[static_cast<std::size_t>(a)], b, row[static_cast<std::size_t>(b)]});
      }
    }
  }
  std::size_t pairs = 0;
  for (std::size_t a = 0; a < counts.size(); ++a) {
    for (std::size_t b = a + 1; b < counts.size(); ++b) pairs += static_cast<std::size_t>(counts[a] * counts[b]);
  }
  EXPECT_EQ(met.size(), pairs);
  EXPECT_LT(rows.size(), 20u);  // all settings are 2304, and 12 rows the least there can be
}

TEST(Cover, OfWhatIsWantedAlone) {
  const auto rows =
      measure::pairwise_cover({2, 2, 2}, 1, [](const measure::ValuePair& p) { return p.a == 0 && p.b == 1; });
  EXPECT_EQ(rows.size(), 4u);
}

TEST(StressCases, CoverEveryParameterOfEveryPassThatAPipelineHas) {
  std::map<std::string, std::string> declared;  // "pipeline pass.param" -> "Type.param"
  std::set<std::string> numbers;                // those of them that are no choices
  const SceneFacts facts = scene::compute_facts(measure::make_room({.lights = 2, .lamp = 3}).scene);
  const auto key = [](const std::string& pipeline, const std::string& pass, const std::string& param) {
    return fs::path(pipeline).stem().string() + " " + pass + "." + param;
  };
  for (const std::string& pipeline : pipelines()) {
    const graph::CompileResult compiled = graph::compile_file(pipeline, all_passes(), facts);
    ASSERT_TRUE(compiled.graph) << pipeline;
    for (const graph::CompiledPass& pass : compiled.graph->passes) {
      if (!pass.runs) continue;
      for (const ParamDecl& decl : pass.params.all()) {
        const std::string name = key(pipeline, pass.name, decl.name);
        if (decl.kind == ParamKind::text) continue;
        declared[name] = pass.type + "." + decl.name;
        if (decl.kind == ParamKind::integer || decl.kind == ParamKind::real) numbers.insert(declared[name]);
      }
    }
  }
  std::set<std::string> tried, quick_types;
  for (const StressCase& c : measure::stress_cases(pipelines(), all_passes())) {
    for (const graph::Override& set : c.set) {
      const std::string name = key(c.pipeline, set.pass, set.param);
      if (c.group == "a parameter at an end") tried.insert(name);
      if (c.group == measure::parameters_group && c.quick) quick_types.insert(declared[name]);
    }
  }
  EXPECT_GT(declared.size(), 100u);
  for (const auto& [name, type] : declared) {
    EXPECT_TRUE(tried.contains(name)) << name;
    EXPECT_TRUE(!numbers.contains(type) || quick_types.contains(type)) << type;
  }
}

}  // namespace
}  // namespace loom::test
