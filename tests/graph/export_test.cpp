// Golden plans, the graph's exports, and the schema against pipelines that are right and wrong.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "graph/compile/export.h"
#include "graph/fakes.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path folder = fs::path(LOOM_SOURCE_DIR) / "tests/graph";

const Registry& types() {
  static const Registry registry = fake_registry();
  return registry;
}

std::string content(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

graph::CompiledGraph compiled(const fs::path& path, const graph::CompileOptions& options = {}) {
  auto result = graph::compile_text(content(path), path.filename().string(), types(), one_light(), options);
  if (result.graph) return std::move(*result.graph);
  ADD_FAILURE() << text_of(result.diagnostics);
  return {};
}

/// A plan is compared as text; LOOM_UPDATE_EXPECTED=1 writes it instead.
void expect_plan(const std::string& pipeline, const std::string& golden, const graph::CompileOptions& options) {
  const std::string plan = graph::plan_json(compiled(folder / "golden" / pipeline, options), one_light());
  const fs::path path = folder / "golden" / golden;
  if (std::getenv("LOOM_UPDATE_EXPECTED") != nullptr)
    std::ofstream(path) << plan;
  else
    EXPECT_EQ(plan, content(path)) << golden;
}

TEST(GoldenPlan, IndirectLightWithHistoryAndInPlaceWriting) {
  expect_plan("temporal.json", "temporal.plan.json", {.frame_size = {64, 32}});
}

TEST(GoldenPlan, TheSameWithoutPruningAndAliasing) {
  expect_plan("temporal.json", "temporal.no_prune.plan.json", {.frame_size = {64, 32}, .alias = false, .prune = false});
}

TEST(PlanJson, HasWhatOthersRelyOn) {
  const json plan = json::parse(graph::plan_json(compiled(folder / "golden/temporal.json"), one_light()));
  EXPECT_EQ(plan.at("version"), 1);
  for (const char* key : {"passes", "resources", "facts", "decisions", "pruned", "memory"})
    EXPECT_TRUE(plan.contains(key)) << key;
  for (const char* key : {"name", "format", "size", "bytes", "first", "last", "slot"})
    EXPECT_TRUE(plan.at("resources").at(0).contains(key)) << key;
  for (const char* key : {"rule", "decision", "evidence"}) EXPECT_TRUE(plan.at("decisions").at(0).contains(key)) << key;
  EXPECT_LT(plan.at("memory").at("textures_bytes"), plan.at("memory").at("without_aliasing_bytes"));
  EXPECT_EQ(plan.at("facts").at("spot_lights"), 1);
}

TEST(GraphJson, ListsPassesWiresAndOutputs) {
  const json graph = json::parse(graph::to_json(compiled(folder / "golden/temporal.json")));
  EXPECT_EQ(graph.at("version"), 1);
  EXPECT_EQ(graph.at("passes").size(), 11U);
  bool history = false;
  for (const auto& wire : graph.at("wires")) history = history || wire.at("history") == true;
  EXPECT_TRUE(history);
  EXPECT_EQ(graph.at("outputs").at(0).at("endpoint"), "show.image");
}

TEST(Dot, ShowsPortsTypesHistoryAndWhatIsLeftOut) {
  const std::string dot = graph::to_dot(compiled(folder / "golden/temporal.json"));
  EXPECT_THAT(dot,
              testing::HasSubstr("\"gbuffer\":\"out_surface\":e -> \"shade\":\"in_surface\":w [label=\"Surface\"]"));
  EXPECT_THAT(dot, testing::HasSubstr("style=dashed"));
  EXPECT_THAT(dot, testing::HasSubstr("<i>nothing reads it</i>"));
  EXPECT_THAT(dot, testing::HasSubstr("\"show\":\"out_image\":e -> \"outputs.image\""));
}

TEST(Dot, EscapesWhatReasonsMayContain) {
  Registry registry;
  add(registry, "Odd",
      [](Ports& ports, const SceneFacts&) { ports.out("image", "Image").absent("a < b && \"c\" > \\d"); });
  const auto result =
      compile(R"({ "passes": { "odd": { "type": "Odd" } }, "outputs": { "image": "odd.image" } })", registry);
  ASSERT_TRUE(result.graph.has_value());
  const std::string dot = graph::to_dot(*result.graph);
  EXPECT_THAT(dot, testing::HasSubstr("a &lt; b &amp;&amp; &quot;c&quot; &gt; &#92;d"));
  EXPECT_THAT(dot, testing::Not(testing::HasSubstr("a < b")));
}

/// What the schema says of a pipeline text.
bool fits_schema(const std::string& text) {
  static const json document = json::parse(graph::pipeline_schema(types()));
  static const auto schema = [] {
    auto parsed = std::make_unique<valijson::Schema>();
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(document), *parsed);
    return parsed;
  }();
  const json instance = json::parse(text);
  valijson::Validator validator;
  return validator.validate(*schema, valijson::adapters::NlohmannJsonAdapter(instance), nullptr);
}

std::string tuned(const std::string& pass) {
  return R"({ "passes": { "s": { "type": "Source" }, "t": )" + pass + R"( }, "outputs": { "image": "s.image" } })";
}

TEST(Schema, AcceptsWhatTheCompilerAccepts) {
  EXPECT_TRUE(fits_schema(content(folder / "golden/temporal.json")));
  EXPECT_TRUE(fits_schema(tuned(R"({ "type": "Tuned", "in": { "image": "s.image" }, "summary": "x", "params":
      { "iterations": 64, "radius": 0.01, "exact": true, "basis": "sg", "label": "x", "tint": [0, 1, 0.5] } })")));
  EXPECT_TRUE(fits_schema(tuned(R"({ "type": "Scripted", "file": "x.comp", "ports": {}, "params": { "own": 1 } })")));
  EXPECT_TRUE(fits_schema(tuned(R"({ "params": { "iterations": null } })"))) << "as in a file that extends another";
  EXPECT_TRUE(fits_schema(tuned("null")));
  EXPECT_TRUE(fits_schema(R"({ "extends": "a.json" })"));
  EXPECT_TRUE(fits_schema(R"({ "$schema": "s", "name": "n", "summary": "s",
      "inputs": { "env": { "type": "Image", "format": "rgba16f", "size": [1, 1] }, "b": { "type": "Image", "size": "frame" } },
      "passes": { "f": { "type": "Filter", "in": { "image": "inputs.env" } } },
      "outputs": { "image": "f.image", "hdr": "f.image.image", "indirect": null, "own": "f.image" } })"));
}

TEST(Schema, RefusesWhatTheCompilerRefuses) {
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tunde" })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "parms": {} })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "in": { "imag": "s.image" } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "in": { "image": "s" } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "iterations": 65 } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "iterations": 1.5 } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "radius": 0 } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "exact": 1 } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "basis": "sq" } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "tint": [0, 1] } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "tint": [0, 1, 2] } })")));
  EXPECT_FALSE(fits_schema(tuned(R"({ "type": "Tuned", "params": { "iteratons": 1 } })")));
  EXPECT_FALSE(fits_schema(R"({ "passes": {}, "outputs": {}, "color": 1 })"));
  EXPECT_FALSE(fits_schema(R"({ "passes": {} })"));
  EXPECT_FALSE(fits_schema(R"({ "passes": { "Bad Name": { "type": "Source" } }, "outputs": {} })"));
  EXPECT_FALSE(fits_schema(R"({ "passes": {}, "outputs": { "image": "x" } })"));
}

TEST(Schema, ShowsDefaultsAsTheyWereWritten) {
  const json schema = json::parse(graph::pipeline_schema(types()));
  for (const auto& rule : schema.at("definitions").at("pass").at("allOf")) {
    if (rule.at("if").at("properties").at("type").at("const") != "Tuned") continue;
    const json& params = rule.at("then").at("properties").at("params").at("properties");
    EXPECT_EQ(params.at("radius").at("default").dump(), "0.7");
    EXPECT_EQ(params.at("radius").at("description"), "how far [m]");
    EXPECT_EQ(params.at("iterations").at("minimum").dump(), "1");
    return;
  }
  FAIL() << "no rule for Tuned";
}

}  // namespace
}  // namespace loom::test
