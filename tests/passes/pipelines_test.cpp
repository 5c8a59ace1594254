// Every shipped pipeline on a small Cornell box: the same bits whatever the executor does with memory.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/bench.h"

namespace loom::test {
namespace {

/// A closed box with two blocks, a spot light and a lamp in the ceiling; left red, right green.
scene::Scene cornell() {
  SceneBuilder scene;
  const int white = scene.material({.73f, .71f, .68f}), red = scene.material({.61f, .06f, .06f});
  const int green = scene.material({.12f, .44f, .11f}), lamp = scene.material(glm::vec3(.8f), {12, 10, 7});
  scene.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
  scene.quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, white);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, white);
  scene.quad({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}, red);
  scene.quad({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}, green);
  scene.quad({-.25f, 1.99f, -.25f}, {.25f, 1.99f, -.25f}, {.25f, 1.99f, .25f}, {-.25f, 1.99f, .25f}, lamp);
  scene.box({-.6f, 0, -.6f}, {-.1f, 1.2f, -.1f}, white).box({.1f, 0, .1f}, {.6f, .5f, .6f}, white);
  return scene.spot({.2f, 1.9f, .1f}, {-.1f, -1, -.2f}, glm::vec3(6), .4, .7).build();
}

class Pipelines : public GlTest, public ::testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (IsSkipped()) return;
    device_ = make_device();
    bench_ = std::make_unique<Bench>(*device_, cornell());
    bench_->look({0, 1, 3.2}, {0, 1, 0}, .4);
  }
  static BenchOptions options() {
    return {
        .size = {48, 40}, .set = {{"rsm", "size", "32"}, {"rsm", "shadow_size", "128"}}, .requested = {"image", "hdr"}};
  }
  [[nodiscard]] std::vector<Texels> outputs(const BenchOptions& how) const {
    bench_->render(GetParam() + ".json", how);
    return {bench_->read("image"), bench_->read("hdr")};
  }
  std::unique_ptr<gpu::CachingDevice> device_;
  std::unique_ptr<Bench> bench_;
};

TEST_P(Pipelines, TheSameBitsWithoutAliasingWithPoisonAndTwice) {
  const auto once = outputs(options());
  for (const Texels& image : once) {
    for (const glm::vec4& texel : image.values) {
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(texel[c]) && texel[c] >= 0);
    }
    EXPECT_GT(image.mean().x, 0);
  }
  EXPECT_TRUE(outputs(options()) == once) << "twice";
  BenchOptions how = options();
  how.alias = false;
  EXPECT_TRUE(outputs(how) == once) << "without aliasing";
  how = options();
  how.poison = true;
  EXPECT_TRUE(outputs(how) == once) << "with poisoned transients";
  how = options();
  how.prune = false;
  EXPECT_TRUE(outputs(how) == once) << "without pruning";
}

TEST_P(Pipelines, AStillSceneKeepsWhatItHas) {
  BenchOptions how = options();
  const auto once = outputs(how);
  how.frames = 3;
  bench_->render(GetParam() + ".json", how);
  const auto kept = bench_->renderer().kept_passes();
  const std::string still = GetParam() == "gbuffer" ? "gbuffer" : "rsm";
  EXPECT_NE(std::find(kept.begin(), kept.end(), still), kept.end()) << still;
  how.prune = false;
  EXPECT_EQ(outputs(how)[0].width, once[0].width);
  EXPECT_TRUE(bench_->renderer().kept_passes().empty());
}

INSTANTIATE_TEST_SUITE_P(Shipped, Pipelines,
                         ::testing::Values("direct", "area", "rsm", "rsm-denoised", "lpv", "lpv-cascaded-fast",
                                           "lpv-surface", "lpv-voxel", "ray-march-fast", "ray-march-probes-fast",
                                           "cone-trace-fast", "radiance-field-fast", "radiance-field-voxel-fast",
                                           "screen-space-fast", "ambient-occlusion-fast", "lpv-near-fast",
                                           "radiance-field-near-fast", "instant-radiosity-fast",
                                           "instant-radiosity-voxel", "instant-radiosity-shadow-maps", "prt-fast",
                                           "visibility-field", "gbuffer"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace loom::test
