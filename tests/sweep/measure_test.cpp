// loom measure as its users see it: a report, going on where it stopped, shares, failures, refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

/// Small, and the reference good enough: straight light alone is far from the truth.
constexpr const char* sweep = R"({
  "name": "test", "scenes": ["cornell-box-emissive"], "size": [24, 16], "samples": 2, "frames": 2, "seeds": 2,
  "reference": { "spp": 256 }, "flicker": { "frames": 4 },
  "pipelines": ["direct", { "pipeline": "area", "set": { "emitter.samples": [1, 4] } }] })";

class Measure : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return dir_ / name; }
  [[nodiscard]] std::vector<std::string> words(const std::string& out,
                                               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> list = {"measure", path("sweep.json"), "-o",
                                     path(out), "--references",     path("references")};
    list.insert(list.end(), more.begin(), more.end());
    return list;
  }
  [[nodiscard]] Json report(const std::string& out) const {
    std::ifstream in(path(out + "/report.json"));
    return Json::parse(in);
  }
  static void expect(const ProcessResult& result, int code) {
    EXPECT_EQ(result.exit_code, code) << result.out << result.err;
  }

  TempDir dir_;
};

TEST_F(Measure, MakesAReportAndMeasuresNothingTwice) {
  std::ofstream(path("sweep.json")) << sweep;
  expect(run_loom(words("all")), 0);
  const Json made = report("all");
  ASSERT_EQ(made["points"].size(), 3u);
  for (const Json& point : made["points"]) {
    EXPECT_TRUE(fs::exists(path("all/" + point["picture"].get<std::string>())));
    EXPECT_TRUE(fs::exists(path("all/" + point["heatmap"].get<std::string>())));
    EXPECT_GT(point["frame"]["wall_ms"]["median"], 0);
    EXPECT_GE(point["frame"]["wall_ms"]["p95"], point["frame"]["wall_ms"]["median"]);
    EXPECT_GT(point["frame"]["cpu_ms"]["median"], 0);
    EXPECT_GT(point["memory"]["textures_bytes"], 0);
    const Json& hdr = point["error"]["hdr"];
    EXPECT_LE(hdr["ci95"][0], hdr["relmse"]);
    EXPECT_GE(hdr["ci95"][1], hdr["relmse"]);
    EXPECT_TRUE(point["flicker"].is_number());
  }
  const Json& direct = made["points"][0];
  EXPECT_EQ(direct["pipeline"], "direct");
  EXPECT_EQ(direct["no_indirect"], true);
  const Json& scene = made["scenes"][0];
  // Without indirect light nothing but the sampling of pixels tells the picture from the reference without it.
  EXPECT_NEAR(direct["error"]["hdr"]["relmse"].get<double>(), scene["without_indirect_relmse"]["hdr"].get<double>(),
              .02);
  EXPECT_NEAR(direct["error"]["indirect"]["relmse"].get<double>(),
              scene["without_indirect_relmse"]["indirect"].get<double>(), 1e-6);
  EXPECT_GT(scene["aliasing_relmse"], 0);
  EXPECT_GT(scene["reference"]["convergence"].size(), 3u);

  // The command of a point makes its picture again: the same error against the same reference.
  const Json& area = made["points"][1];
  const std::string command = area["commands"]["render"];
  const std::string picture = path(area["key"].get<std::string>() + ".exr");
  expect(run_process("/bin/bash", {"-c", "cd '" + dir_.path() + "' && '" LOOM_BINARY_DIR "/bin/" +
                                             command.substr(0, 4) + "'" + command.substr(4)}),
         0);
  std::string reference;
  for (const auto& entry : fs::directory_iterator(path("references"))) {
    if (entry.path().extension() == ".exr") reference = entry.path();
  }
  const ProcessResult compared = run_loom({"compare", picture, reference, "--json"});
  expect(compared, 0);
  // Of the two seeds' mean, the first is away by their deviation/√2.
  EXPECT_NEAR(Json::parse(compared.out)["relmse"].get<double>(), area["error"]["hdr"]["relmse"].get<double>(),
              area["error"]["hdr"]["seed_sd"].get<double>() / 1.41421 + 1e-7);

  // A killed sweep: one result is missing, one was touched by hand. The former is made, the latter left as it is.
  const std::string first = path("all/points/" + made["points"][0]["key"].get<std::string>() + ".json");
  Json marked = Json::parse(std::ifstream(first));
  marked["flicker"] = 42;
  std::ofstream(first) << marked;
  fs::remove(path("all/points/" + made["points"][2]["key"].get<std::string>() + ".json"));
  const ProcessResult again = run_loom(words("all"));
  expect(again, 0);
  EXPECT_THAT(again.err, HasSubstr("2 of 3 points are measured already"));
  EXPECT_EQ(report("all")["points"][0]["flicker"], 42);
  EXPECT_EQ(report("all")["points"].size(), 3u);
}

TEST_F(Measure, SharesAddUp) {
  std::ofstream(path("sweep.json")) << sweep;
  expect(run_loom(words("a", {"--shard", "1/2", "--no-flicker"})), 0);
  expect(run_loom(words("b", {"--shard", "2/2", "--no-flicker"})), 0);
  EXPECT_EQ(report("a")["points"].size(), 2u);
  EXPECT_EQ(report("b")["points"].size(), 1u);
  EXPECT_EQ(report("a")["expected"], 3);
  expect(run_loom(words("sum", {"--no-flicker", "--merge", path("a"), path("b")})), 0);
  EXPECT_EQ(report("sum")["points"].size(), 3u);
  EXPECT_EQ(report("sum")["scenes"].size(), 1u);
}

TEST_F(Measure, GoesOnWhereOnePointFailsAndSaysSo) {
  std::ofstream(path("broken.json")) << R"({ "extends": ")" LOOM_SOURCE_DIR R"(/pipelines/direct.json", "passes": {
    "bad": { "type": "Shader", "file": "bad.comp", "in": { "hdr": "composite.radiance" }, "ports": {
      "in": { "hdr": "Image" }, "out": { "image": { "type": "Image", "format": "rgba32f", "size": "frame" } } } },
    "tonemap": { "in": { "hdr": "bad.image" } } } })";
  std::ofstream(path("bad.comp")) << "this is no GLSL\n";
  std::ofstream(path("sweep.json")) << R"({ "scenes": ["cornell-box"], "size": [16, 16], "frames": 1, "seeds": 1,
    "samples": 1, "reference": { "spp": 16 }, "pipelines": ["broken.json", "direct"] })";
  const ProcessResult result = run_loom(words("out", {"--json"}));
  expect(result, 1);
  const Json said = Json::parse(result.out);
  EXPECT_EQ(said["points"], 2);
  EXPECT_EQ(said["failed"], 1);
  EXPECT_THAT(result.err, HasSubstr("bad.comp"));
  EXPECT_TRUE(report("out")["points"][1].contains("error"));
}

TEST_F(Measure, RefusesAReferenceThatIsTooNoisyAndBadArguments) {
  std::ofstream(path("sweep.json"))
      << R"({ "scenes": ["cornell-box-emissive"], "size": [24, 16], "frames": 1, "seeds": 1,
    "samples": 4, "reference": { "spp": 16 }, "pipelines": ["lpv"] })";
  const ProcessResult result = run_loom(words("out"));
  expect(result, 1);
  EXPECT_THAT(result.err, HasSubstr("reference-too-noisy"));
  EXPECT_EQ(report("out")["refused_references"].size(), 1u);
  expect(run_loom(words("out", {"--shard", "3/2"})), 2);
  expect(run_loom(words("out", {"--point", "nothing"})), 2);
  expect(run_loom({"measure", path("nothing.json"), "-o", path("out")}), 2);
}

}  // namespace
}  // namespace loom::test
