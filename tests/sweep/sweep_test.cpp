// Sweep files and their points: what may be written, what it expands to, what is said of mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>
#include <vector>

#include "loom/diagnostic.h"
#include "measure/sweep/expand.h"
#include "measure/sweep/sweep.h"
#include "support/bench.h"
#include "support/temp_dir.h"

namespace loom::measure {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Names as the command line finds them, without the command line.
Names names() {
  const auto in = [](const std::vector<std::string>& places) {
    return [places](const std::string& name) {
      for (const std::string& place : places) {
        std::string path = LOOM_SOURCE_DIR + place;
        path.replace(path.find('*'), 1, name);
        if (std::filesystem::exists(path)) return path;
      }
      throw BadInput("no such thing: " + name);
    };
  };
  return {.scene = in({"/configs/scenes/*.gltf", "/configs/runs/*.json"}), .pipeline = in({"/pipelines/*.json"})};
}

class SweepFile : public testing::Test {
 protected:
  Sweep read(const std::string& text) const {
    std::ofstream(dir_ / "sweep.json") << text;
    return read_sweep(dir_ / "sweep.json", names());
  }
  std::vector<Point> points(const std::string& pipelines) const {
    return expand(read(R"({ "scenes": ["cornell-box"], "pipelines": )" + pipelines + " }"), test::all_passes());
  }
  /// What is thrown, as people read it.
  template <class Work>
  static std::string complaint(const Work& work) {
    try {
      work();
    } catch (const BadInput& problem) {
      std::string text;
      for (const Diagnostic& d : problem.diagnostics().all()) text += to_string(d) + "\n";
      return text;
    }
    return "nothing was thrown";
  }
  static std::vector<std::string> values(const std::vector<Point>& points) {
    std::vector<std::string> list;
    for (const Point& point : points) list.push_back(point.set.front().value);
    return list;
  }

  test::TempDir dir_;
};

TEST_F(SweepFile, StepsThroughARangeByTheParametersScale) {
  // RayMarch.rays is stepped by ratio, GatherVolume.blend evenly, cascades are whole and repeat: one of each is enough.
  EXPECT_THAT(
      values(points(R"([{ "pipeline": "ray-march", "set": { "march.rays": { "from": 4, "to": 64, "steps": 3 } } }])")),
      ElementsAre("4", "16", "64"));
  EXPECT_THAT(values(points(R"([{ "pipeline": "lpv", "set": { "bounce.blend": { "steps": 3 } } }])")),
              ElementsAre("0.0", "4.0", "8.0"));
  EXPECT_THAT(
      values(points(R"([{ "pipeline": "lpv", "set": { "lpv.bounces": { "from": 1, "to": 3, "steps": 9 } } }])")),
      ElementsAre("1", "2", "3"));
  EXPECT_THAT(values(points(R"([{ "pipeline": "lpv", "set": { "lpv.blockers": "all" } }])")),
              ElementsAre("\"faces\"", "\"sh\""));
}

TEST_F(SweepFile, TakesOnePointOfEachPipelineInTurnAndGivesEachAKeyOfItsOwn) {
  const std::string pipelines =
      R"(["direct", { "pipeline": "lpv", "set": { "lpv.iterations": [4, 8], "inject.grid": [4, 8] } }, { "pipeline": "lpv", "set": { "lpv.iterations": 4, "inject.grid": 4 } }])";
  const std::vector<Point> all = points(pipelines);
  ASSERT_EQ(all.size(), 5u) << "a point that stands in two grids is measured once";
  EXPECT_EQ(all[0].entry, 0u);
  EXPECT_EQ(all[1].entry, 1u);
  std::set<std::string> keys;
  for (const Point& point : all) keys.insert(point.key);
  EXPECT_EQ(keys.size(), all.size());
  const std::vector<Point> again = points(pipelines);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].key, again[i].key);
  // How it is measured is part of what a point is.
  const Sweep finer = read(R"({ "scenes": ["cornell-box"], "samples": 16, "pipelines": ["direct"] })");
  EXPECT_NE(expand(finer, test::all_passes()).front().key, all[0].key);
}

TEST_F(SweepFile, SharesAreDisjointAndWhole) {
  const std::vector<Point> all =
      points(R"([{ "pipeline": "ray-march", "set": { "march.rays": [1, 2, 3, 4, 5, 6, 7] } }])");
  std::set<std::string> keys;
  for (int i = 1; i <= 3; ++i) {
    for (const Point& point : shard(all, i, 3)) EXPECT_TRUE(keys.insert(point.key).second);
  }
  EXPECT_EQ(keys.size(), all.size());
}

TEST_F(SweepFile, NamesEveryMistakeAtItsPlace) {
  EXPECT_THAT(
      complaint([&] { read("{ \"scenes\": [\"cornell-box\"],\n  \"pipelines\": [\"lpw\"], \"sampels\": 4 }"); }),
      AllOf(HasSubstr("sweep.json:2:17: error[failed]: no such thing: lpw"),
            HasSubstr("sweep.json:2:25: error[unknown-key]: a sweep has no key `sampels`"),
            HasSubstr("did you mean `samples`?")));
  EXPECT_THAT(complaint([&] { read(R"({ "scenes": [], "pipelines": [{ "set": {} }], "reference": { "spp": 4 } })"); }),
              AllOf(HasSubstr("a sweep names no scenes"), HasSubstr("there is no `pipeline` here"),
                    HasSubstr("`spp` is 4, outside 16")));
  EXPECT_THAT(complaint([&] { points(R"([{ "pipeline": "lpv", "set": { "lpf.iterations": 4 } }])"); }),
              AllOf(HasSubstr(":1:74: error[unknown-pass]"), HasSubstr("did you mean `lpv`?")));
  EXPECT_THAT(complaint([&] { points(R"([{ "pipeline": "lpv", "set": { "lpv.iterations": [4, 9999] } }])"); }),
              HasSubstr(":1:96: error[param-range]: `lpv.iterations` = 9999 is outside 0"));
  EXPECT_THAT(complaint([&] { points(R"([{ "pipeline": "lpv", "set": { "lpv.blockers": { "steps": 3 } } }])"); }),
              HasSubstr("is no number, so it has no range"));
  std::ofstream(dir_ / "bare.json") << R"({ "passes": { "g": { "type": "GBuffer" }, "v": { "type": "DebugView",
    "in": { "surface": "g.surface" } } }, "outputs": { "image": "v.image" } })";
  EXPECT_THAT(
      complaint([&] { points(R"(["bare.json"])"); }),
      AllOf(HasSubstr("sweep.json:1:44: error[bad-pipeline]: `bare.json` cannot be measured"), HasSubstr("hdr")));
}

TEST_F(SweepFile, ShippedSweepsFitTheSchemaAndThePasses) {
  const auto load = [](const std::filesystem::path& path) {
    std::ifstream in(path);
    return nlohmann::json::parse(in);
  };
  const std::filesystem::path configs = LOOM_SOURCE_DIR "/configs";
  valijson::Schema schema;
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  const nlohmann::json document = load(configs / "schemas/sweep.schema.json");
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(document), schema);
  valijson::Validator validator;
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(configs / "sweeps")) {
    const nlohmann::json sweep = load(entry.path());
    EXPECT_TRUE(validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(sweep), nullptr)) << entry.path();
    EXPECT_GT(expand(read_sweep(entry.path().string(), names()), test::all_passes()).size(), 10u);
    ++seen;
  }
  EXPECT_GE(seen, 2u);
  EXPECT_FALSE(validator.validate(
      schema,
      valijson::adapters::NlohmannJsonAdapter(nlohmann::json::parse(R"({ "scenes": ["x"], "pipelines": [4] })")),
      nullptr));
}

// The reference is what the others are measured against, the views of the G-buffer are no method.
TEST_F(SweepFile, TheTableHasEveryShippedPipeline) {
  std::set<std::string> measured{"reference", "gbuffer"}, shipped;
  const Sweep sweep = read_sweep(LOOM_SOURCE_DIR "/configs/sweeps/pipelines.json", names());
  for (const SweepEntry& entry : sweep.pipelines) measured.insert(entry.name);
  for (const auto& entry : std::filesystem::directory_iterator(LOOM_SOURCE_DIR "/pipelines"))
    if (entry.path().extension() == ".json") shipped.insert(entry.path().stem().string());
  EXPECT_EQ(measured, shipped);
}

}  // namespace
}  // namespace loom::measure
