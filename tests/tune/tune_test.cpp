// loom tune as its users see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

class Tune : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult tune(const std::vector<std::string>& promise) const {
    std::ofstream(dir_ / "space.json") << R"({ "scenes": ["cornell-box"], "size": [16, 16], "samples": 4, "frames": 2,
      "seeds": 1, "reference": { "spp": 512 },
      "pipelines": ["direct", { "pipeline": "area", "set": { "emitter.samples": [4, 16] } }] })";
    std::vector<std::string> words = {
        "tune", "cornell-box-emissive", "--space",      dir_ / "space.json", "--work", dir_ / "work",
        "-o",   dir_ / "best.json",     "--references", dir_ / "references", "--json", "--evaluations",
        "3"};
    words.insert(words.end(), promise.begin(), promise.end());
    return run_loom(words);
  }
  TempDir dir_;
};

TEST_F(Tune, WritesAPipelineThatKeepsThePromise) {
  // Without any emitter's light the relMSE is about .2, with its straight light below .1 (docs/results.md).
  const ProcessResult result = tune({"--max-error", ".12"});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  const Json said = Json::parse(result.out);
  EXPECT_EQ(said["best"]["pipeline"], "area");
  EXPECT_LE(said["best"]["hdr_relmse"], .12);
  EXPECT_TRUE(said["twice_as_accurate"].is_null());

  std::ifstream in(dir_ / "best.json");
  const Json pipeline = Json::parse(in);
  EXPECT_EQ(pipeline["measured"]["result"]["hdr_relmse"], said["best"]["hdr_relmse"]);
  EXPECT_EQ(pipeline["measured"]["scene"], "cornell-box-emissive");
  EXPECT_EQ(pipeline["passes"]["emitter"]["params"]["samples"], said["best"]["set"]["emitter.samples"]);
  const ProcessResult rendered =
      run_loom({"render", "cornell-box-emissive", "-p", dir_ / "best.json", "-o", dir_ / "x.exr", "--size", "16x16"});
  EXPECT_EQ(rendered.exit_code, 0) << rendered.err;

  // With all the time in the world the most accurate is taken; what was measured before is known.
  const ProcessResult slow = tune({"--budget-ms", "1e9"});
  ASSERT_EQ(slow.exit_code, 0) << slow.out << slow.err;
  const Json most = Json::parse(slow.out)["best"];
  EXPECT_EQ(most["pipeline"], "area");
  EXPECT_LE(most["hdr_relmse"], said["best"]["hdr_relmse"]);
}

TEST_F(Tune, SaysThatNothingKeepsThePromise) {
  const ProcessResult result = tune({"--max-error", "1e-5"});
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_THAT(result.err, HasSubstr("none of 3 settings tried, of 3, keeps a relMSE of 1e-05"));
  EXPECT_EQ(Json::parse(result.out)["nearest"]["pipeline"], "area");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "best.json"));
  EXPECT_EQ(run_loom({"tune", "-o", dir_ / "best.json"}).exit_code, 2);
}

}  // namespace
}  // namespace loom::test
