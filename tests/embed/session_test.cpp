#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "loom/lightloom.h"
#include "support/gl.h"
#include "support/process.h"

namespace loom {
namespace {

using ::testing::HasSubstr;

class SessionTest : public test::GlTest {
 protected:
  static Session open() {
    return Session::open({.plugin_dirs = {LOOM_BINARY_DIR "/lib/loom/passes"},
                          .shader_dirs = {LOOM_SOURCE_DIR "/shaders"},
                          .cache_dir = "-"});
  }
  static std::string message(const auto& call) {
    try {
      call();
    } catch (const BadInput& error) {
      return error.what();
    }
    return "no error";
  }
};

double mean(const std::vector<glm::vec4>& texels) {
  double sum = 0;
  for (const glm::vec4& texel : texels) sum += texel.x;
  return sum / static_cast<double>(texels.size());
}

TEST_F(SessionTest, RendersAndHandsTexturesBack) {
  Session session = open();
  session.load_scene("");
  session.load_pipeline("direct", {.size = {64, 48}});
  session.render();
  const OutputTexture image = session.output();
  EXPECT_TRUE(glIsTexture(image.texture));
  EXPECT_EQ(image.desc.width, 64);
  EXPECT_EQ(image.desc.height, 48);
  EXPECT_EQ(image.quantity, "display");
  EXPECT_EQ(session.output("hdr").quantity, "radiance");
  EXPECT_EQ(session.output("indirect").texture, 0u) << "absent";
  EXPECT_GT(mean(session.read("hdr")), 0);
  EXPECT_EQ(session.read().size(), 64u * 48u);
  EXPECT_GT(session.gpu_ms(), 0);
}

TEST_F(SessionTest, ResizesSetsAndLooksElsewhere) {
  Session session = open();
  session.load_scene("");
  session.load_pipeline("direct", {.size = {32, 32}, .set = {{"rsm.shadow_size", "256"}}, .outputs = {"hdr"}});
  session.render();
  const auto before = session.read("hdr");
  session.resize({16, 16});
  session.render();
  EXPECT_EQ(session.read("hdr").size(), 256u);
  session.resize({32, 32});
  session.render();
  EXPECT_EQ(session.read("hdr"), before);
  session.set("direct.shadow", "none");  // costs a compilation
  session.render();
  EXPECT_GT(mean(session.read("hdr")), mean(before)) << "no shadows";
  session.set_view({.eye = {0, 1, 100}, .target = {0, 1, 200}});
  session.render();
  EXPECT_EQ(mean(session.read("hdr")), 0) << "looking away, under a black sky";
}

TEST_F(SessionTest, SaysWhatIsMissing) {
  Session session = open();
  EXPECT_THAT(message([&] { session.render(); }), HasSubstr("no pipeline is loaded"));
  EXPECT_THAT(message([&] { session.load_pipeline("direct"); }), HasSubstr("none is loaded"));
  session.load_scene("");
  EXPECT_THAT(message([&] { session.load_pipeline(""); }), HasSubstr("names none"));
  EXPECT_THAT(message([&] { session.load_pipeline("not/there.json"); }), HasSubstr("not/there.json"));
  session.load_pipeline("direct", {.size = {8, 8}});
  EXPECT_THAT(message([&] { session.set("rsm.sise", "3"); }), HasSubstr("sise"));
  EXPECT_THAT(message([&] { session.set("rsm", "3"); }), HasSubstr("pass.param"));
  session.render();
}

TEST_F(SessionTest, TwoSessionsSideBySide) {
  Session first = open();
  Session second = open();
  first.load_scene("");
  second.load_scene("");
  first.load_pipeline("direct", {.size = {16, 16}});
  second.load_pipeline("direct", {.size = {32, 32}});
  for (int i = 0; i < 2; ++i) {
    first.render();
    second.render();
  }
  EXPECT_EQ(first.read().size(), 256u);
  EXPECT_EQ(second.read().size(), 1024u);
  second = std::move(first);
  second.render();
  EXPECT_EQ(second.read().size(), 256u);
}

TEST_F(SessionTest, OwnContext) {
  {
    Session session = Session::open({.own_context = true, .cache_dir = "-"});
    session.load_scene("");
    session.load_pipeline("direct", {.size = {16, 16}});
    session.render();
    EXPECT_GT(mean(session.read("hdr")), 0);
  }
  std::string why;
  test::shared_context(why);
}

// What the program hands in counts: L grows by ρ/π·E, twice as much for twice the irradiance.
TEST_F(SessionTest, TheExampleOfTheManualRuns) {
  const test::ProcessResult result = test::run_process(LOOM_EMBEDDING_EXAMPLE, {});
  if (result.exit_code == 77)
    GTEST_SKIP() << "the example makes its context on the surfaceless platform: " << result.out;
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  std::istringstream lines(result.out);
  std::string line;
  std::vector<double> means;
  while (std::getline(lines, line)) means.push_back(std::stod(line.substr(line.find("radiance ") + 9)));
  ASSERT_EQ(means.size(), 3u) << result.out;
  EXPECT_GT(means[1], means[0]);
  EXPECT_NEAR((means[2] - means[0]) / (means[1] - means[0]), 2, 1e-3);
}

}  // namespace
}  // namespace loom
