// check, plan, graph, passes, info, new-pass.
#include <set>
#include <string>
#include <vector>

#include "cli/cli.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Inspect = Cli;

std::vector<std::string> json_files(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST_F(Inspect, ShippedPipelinesAreRightForShippedScenes) {
  std::vector<std::string> arguments = {"check"};
  for (const std::string& file : json_files(fs::path(LOOM_SOURCE_DIR) / "pipelines")) arguments.push_back(file);
  ASSERT_GT(arguments.size(), 3u);
  EXPECT_THAT(expect(0, arguments).err, IsEmpty());
  arguments.insert(arguments.end(), {"--scene", "cornell-box-emissive"});
  EXPECT_THAT(expect(0, arguments).err, IsEmpty());
}

TEST_F(Inspect, EveryBadPipelineIsRefusedAndLeavesNoFile) {
  const std::vector<std::string> bad = json_files(fs::path(LOOM_SOURCE_DIR) / "tests/graph/bad");
  ASSERT_GT(bad.size(), 20u);
  for (const std::string& file : bad) {
    const ProcessResult checked = expect(2, {"check", file});
    EXPECT_THAT(checked.err, HasSubstr(": error[")) << file;
    EXPECT_THAT(expect(2, render(file, path("x.png"), {"--stats", path("s.json")})).err, HasSubstr(": error[")) << file;
    EXPECT_THAT(files(), IsEmpty()) << file;
  }
}

TEST_F(Inspect, CheckReportsAllOfAllFiles) {
  const std::string bad = dir_.write("bad.json", R"({
  "name": "bad",
  "passes": {
    "a": { "type": "Tonmap" },
    "b": { "type": "Tonemap", "in": { "hdr": "nobody.image" }, "params": { "exposre": 1 } }
  },
  "outputs": { "image": "b.image" }
})");
  const ProcessResult result = expect(2, {"check", "direct", bad, "missing.json", "--json"});
  const Json document = Json::parse(result.out);
  EXPECT_EQ(document.at("version"), 1);
  EXPECT_EQ(document.at("ok"), false);
  std::set<std::string> codes;
  for (const Json& diagnostic : document.at("diagnostics")) {
    EXPECT_THAT(keys(diagnostic),
                ElementsAre("severity", "code", "message", "file", "line", "column", "pointer", "hint"));
    codes.insert(diagnostic.at("code"));
    if (diagnostic.at("code") == "unknown-type") {
      EXPECT_EQ(diagnostic.at("file"), bad);
      EXPECT_EQ(diagnostic.at("line"), 4);
      EXPECT_THAT(diagnostic.at("hint").get<std::string>(), HasSubstr("Tonemap"));
    }
  }
  EXPECT_THAT(codes, testing::IsSupersetOf({"unknown-type", "unknown-pass", "unknown-param", "no-such-pipeline"}));
  const Json good = Json::parse(expect(0, {"check", "direct", "--json"}).out);
  EXPECT_EQ(good.at("ok"), true);
  EXPECT_TRUE(good.at("diagnostics").empty());
}

TEST_F(Inspect, PlanSaysWhatRunsAndWhatWasLeftOut) {
  const Json plan = Json::parse(expect(0, {"plan", "-p", "lpv", "--json", "--size", "64x64"}).out);
  for (const char* key : {"version", "passes", "resources", "facts", "decisions"})
    EXPECT_TRUE(plan.contains(key)) << key;
  for (const Json& resource : plan.at("resources")) {
    for (const char* key : {"name", "format", "size", "bytes", "first", "last", "slot"}) {
      EXPECT_TRUE(resource.contains(key)) << key;
    }
  }
  for (const Json& decision : plan.at("decisions")) {
    EXPECT_THAT(keys(decision), ElementsAre("rule", "decision", "evidence"));
  }
  // The built-in box has a lamp and nothing that emits: emitter is not run, and the plan says why.
  const std::string table = expect(0, {"plan", "-p", "lpv"}).out;
  EXPECT_THAT(table, HasSubstr("\nleft out\n"));
  EXPECT_THAT(table, HasSubstr("\n  emitter  "));
  EXPECT_THAT(table, HasSubstr("without aliasing"));
}

TEST_F(Inspect, GraphInThreeLanguages) {
  const std::string svg = expect(0, {"graph", "rsm"}).out;
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("composite"));
  EXPECT_THAT(expect(0, {"graph", "rsm", "--format", "dot"}).out, testing::StartsWith("digraph"));
  EXPECT_EQ(Json::parse(expect(0, {"graph", "rsm", "--format", "json"}).out).at("version"), 1);
  expect(0, {"graph", "rsm", "-o", path("rsm.svg")});
  EXPECT_EQ(text_of(path("rsm.svg")), svg);
}

TEST_F(Inspect, PassesAreDescribedByTheirDeclarations) {
  EXPECT_THAT(expect(0, {"passes"}).out, HasSubstr("\nTonemap "));
  const std::string tonemap = expect(0, {"passes", "Tonemap"}).out;
  EXPECT_THAT(tonemap, HasSubstr("exposure"));
  EXPECT_THAT(tonemap, HasSubstr("in   hdr"));
  const Json document = Json::parse(expect(0, {"passes", "Tonemap", "--json"}).out);
  ASSERT_EQ(document.at("passes").size(), 1u);
  const Json& pass = document.at("passes")[0];
  EXPECT_THAT(keys(pass), ElementsAre("type", "summary", "plugin", "in", "out", "params"));
  EXPECT_THAT(pass.at("plugin").get<std::string>(), testing::EndsWith("loom/passes/tonemap.so"));
}

TEST_F(Inspect, CommittedSchemaIsCurrent) {
  const std::string committed = text_of(std::string(LOOM_SOURCE_DIR) + "/configs/schemas/pipeline.schema.json");
  EXPECT_EQ(expect(0, {"passes", "--schema"}).out, committed)
      << "the passes changed: build/bin/loom passes --schema > configs/schemas/pipeline.schema.json";
}

TEST_F(Inspect, RefusedPluginsAreNamedAndTheRestWorks) {
  dir_.write("plugins/broken.so", "no library");
  const ProcessResult passes = expect(1, {"passes", "--plugins", path("plugins")});
  EXPECT_THAT(passes.err, HasSubstr("broken.so: error[plugin-load]"));
  EXPECT_THAT(passes.out, HasSubstr("Tonemap"));
  const ProcessResult check = expect(0, {"check", "direct", "--plugins", path("plugins")});
  EXPECT_THAT(check.err, HasSubstr("broken.so: error[plugin-load]"));
  const Json document = Json::parse(expect(1, {"passes", "--json", "--plugins", path("plugins")}).out);
  EXPECT_EQ(document.at("diagnostics")[0].at("code"), "plugin-load");
}

TEST_F(Inspect, InfoOfTheBuiltInScene) {
  EXPECT_THAT(expect(0, {"info"}).out, HasSubstr("triangles"));
  const Json info = Json::parse(expect(0, {"info", "--json"}).out);
  EXPECT_EQ(info.at("version"), 1);
  EXPECT_EQ(info.at("lights").size(), 1u);
  EXPECT_EQ(info.at("lights")[0].at("type"), "spot");
  EXPECT_GT(Json::parse(expect(0, {"info", "cornell-box-emissive", "--json"}).out).at("emissive_triangles").get<int>(),
            0);
}

/// Runs loom in the test's folder.
ProcessResult run_in(const std::string& folder, const std::string& arguments) {
  return run_process("/bin/sh", {"-c", "cd '" + folder + "' && '" LOOM_BINARY_DIR "/bin/loom' " + arguments});
}

TEST_F(Inspect, NewPassWritesOneFolder) {
  const ProcessResult result = run_in(dir_.path(), "new-pass ScreenSpaceRSM");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(files(), ElementsAre("screen_space_rsm"));
  for (const char* file : {"screen_space_rsm.cpp", "CMakeLists.txt", "README.md", "screen_space_rsm.json",
                           "shaders/screen_space_rsm/screen_space_rsm.comp"}) {
    EXPECT_TRUE(fs::is_regular_file(path("screen_space_rsm") + "/" + file)) << file;
  }
  EXPECT_THAT(text_of(path("screen_space_rsm/screen_space_rsm.cpp")), HasSubstr("class ScreenSpaceRSM final"));
  const ProcessResult again = run_in(dir_.path(), "new-pass screen_space_rsm");
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("exists already"));
}

TEST_F(Inspect, NewPassRefusesNamesThatAreNone) {
  for (const char* name : {"1st", "my.pass", "../up", "''", "'a b'", "Tonemap"}) {
    EXPECT_EQ(run_in(dir_.path(), std::string("new-pass -- ") + name).exit_code, 2) << name;
    EXPECT_THAT(files(), IsEmpty());
  }
}

}  // namespace
}  // namespace loom::test
