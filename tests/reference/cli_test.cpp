// loom reference, as a user runs it.
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::reference::test {
namespace {

using loom::test::ProcessResult;
using loom::test::run_loom;

class ReferenceCommand : public ::testing::Test {
 protected:
  /// The built-in scene at a size that takes no time.
  [[nodiscard]] ProcessResult reference(const std::string& output, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"reference", "-o", dir_ / output, "--size", "24x16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_loom(arguments);
  }
  [[nodiscard]] std::string bytes(const std::string& name) const {
    std::ifstream in(dir_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  loom::test::TempDir dir_;
};

TEST_F(ReferenceCommand, WritesEveryLayer) {
  const ProcessResult result = reference("ref.exr", {"--spp", "16"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ImageLayers image = read_exr(dir_ / "ref.exr");
  EXPECT_EQ(image.width, 24);
  EXPECT_EQ(image.height, 16);
  for (const std::string layer : {"", "direct.", "emitter.", "bounce.", "indirect.", "albedo.", "normal.", "stderr."}) {
    for (const std::string channel : {"R", "G", "B"}) EXPECT_TRUE(image.channels.contains(layer + channel)) << layer;
  }
  EXPECT_TRUE(image.channels.contains("depth.Z"));
  EXPECT_EQ(image.channels.size(), 25U);
  EXPECT_EQ(image.attributes.at("loom:quantity"), "radiance");
}

// Photon maps give the same layers, go on where they were, and are no paths.
TEST_F(ReferenceCommand, MapsPhotons) {
  const std::vector<std::string> photons = {"--method", "photons", "--photons", "2000", "--spp"};
  const auto with = [&](const char* passes) {
    auto arguments = photons;
    arguments.emplace_back(passes);
    return arguments;
  };
  ASSERT_EQ(reference("a.exr", with("2")).exit_code, 0);
  ASSERT_EQ(reference("a.exr", with("4")).exit_code, 0);
  ASSERT_EQ(reference("b.exr", with("4")).exit_code, 0);
  EXPECT_EQ(read_exr(dir_ / "a.exr").channels, read_exr(dir_ / "b.exr").channels);
  EXPECT_EQ(read_exr(dir_ / "a.exr").channels.size(), 25U);
  EXPECT_EQ(reference("a.exr", {"--spp", "16"}).exit_code, 2);
  const ProcessResult unknown = reference("c.exr", {"--method", "bidirectional"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("paths or photons"), std::string::npos) << unknown.err;
}

// A second call adds the missing samples and gives the file that one call would have given.
TEST_F(ReferenceCommand, ContinuesAndEndsTheSame) {
  ASSERT_EQ(reference("a.exr", {"--spp", "16"}).exit_code, 0);
  ASSERT_EQ(reference("a.exr", {"--spp", "32"}).exit_code, 0);
  ASSERT_EQ(reference("b.exr", {"--spp", "32", "--threads", "1"}).exit_code, 0);
  EXPECT_EQ(read_exr(dir_ / "a.exr").channels, read_exr(dir_ / "b.exr").channels);
}

TEST_F(ReferenceCommand, MergesAndSaysSoInJson) {
  ASSERT_EQ(reference("a.exr", {"--spp", "16", "--bounces", "1"}).exit_code, 0);
  ASSERT_EQ(reference("b.exr", {"--spp", "32", "--bounces", "1", "--seed", "7"}).exit_code, 0);
  const ProcessResult result =
      run_loom({"reference", "-o", dir_ / "m.exr", "--json", "--merge", dir_ / "a.exr", dir_ / "b.exr.film"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["spp"], 48);
  EXPECT_EQ(json["seeds"], (std::vector<int>{0, 7}));
  EXPECT_EQ(json["non_finite"], 0);
  EXPECT_GT(json["noise"], 0);
  // (16·a + 32·b)/48 in every channel but the error.
  const ImageLayers a = read_exr(dir_ / "a.exr"), b = read_exr(dir_ / "b.exr"), m = read_exr(dir_ / "m.exr");
  for (const std::string channel : {"R", "G", "B", "bounce.G", "direct.R"}) {
    for (std::size_t i = 0; i < m.channels.at(channel).size(); ++i) {
      const float expected = (a.channels.at(channel)[i] + 2 * b.channels.at(channel)[i]) / 3;
      ASSERT_NEAR(m.channels.at(channel)[i], expected, 1e-6F * (1 + expected)) << channel;
    }
  }
}

TEST_F(ReferenceCommand, JsonTellsErrorAgainstTime) {
  const ProcessResult result = reference("ref.exr", {"--noise", "0.1", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_LE(json["noise"], .1);
  ASSERT_FALSE(json["convergence"].empty());
  EXPECT_EQ(json["convergence"].back()["spp"], json["spp"]);
  EXPECT_EQ(json["convergence"].back()["noise"], json["noise"]);
  EXPECT_GT(json["rays_per_s"], 0);
  EXPECT_GT(json["paths_per_s"], 0);
}

TEST_F(ReferenceCommand, BadInputIsSaidAndNothingWritten) {
  const auto refused = [&](const std::string& output, const std::vector<std::string>& more, const std::string& says) {
    const ProcessResult result = reference(output, more);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_TRUE(bytes(output).empty());
  };
  refused("x.png", {}, ".exr");
  refused("no-such-folder/x.exr", {}, "no folder");
  refused("x.exr", {"--spp", "0"}, "--spp");
  refused("x.exr", {"--noise", "-1"}, "--noise");
  refused("x.exr", {"--noise", "0.1", "--spp", "16"}, "--spp");
  refused("x.exr", {"--bounces", "-2"}, "--bounces");
  refused("x.exr", {"--merge", dir_ / "absent.exr"}, "absent.exr.film");
  ASSERT_EQ(reference("a.exr", {"--spp", "16"}).exit_code, 0);
  refused("x.exr", {"--merge", dir_ / "a.exr", dir_ / "a.exr"}, "seed 0");
  const std::string before = bytes("a.exr");
  EXPECT_EQ(reference("a.exr", {"--spp", "16", "--seed", "3"}).exit_code, 2);
  EXPECT_EQ(reference("a.exr", {"--spp", "16", "--bounces", "3"}).exit_code, 2);
  EXPECT_EQ(bytes("a.exr"), before);
}

}  // namespace
}  // namespace loom::reference::test
