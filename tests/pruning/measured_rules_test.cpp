// What `loom analyse` measures changes plans: how far the rules that go by it move the picture.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/rules.h"
#include "picture_distance.h"
#include "reference/analysis.h"
#include "support/bench.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

class MeasuredRules : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  /// A bench whose scene was measured, as by `loom analyse`.
  std::unique_ptr<Bench> measured(const scene::Scene& scene) const {
    auto bench = std::make_unique<Bench>(*device_, scene);
    const scene::Camera camera = look_at({.3, .2, .4}, {-.4, -.1, -.3});
    bench->look({.3, .2, .4}, {-.4, -.1, -.3}, .6);
    bench->measured(reference::measure_scene(scene, camera, {.surface_points = 512, .probes = 2, .face_side = 8}));
    return bench;
  }
  static BenchOptions options(const std::string& probes, const std::vector<std::string>& without = {}) {
    return {.size = {24, 24},
            .set = {{"field", "probes", probes}, {"field", "order", "2"}, {"rsm", "shadow_size", "256"}},
            .requested = {"bounce", "field.field.coefficients"},
            .disabled_rules = without};
  }
  static bool decided(const Bench& bench, const std::string& rule) {
    const auto& decisions = bench.renderer().graph().decisions;
    return std::any_of(decisions.begin(), decisions.end(), [&](const Decision& d) { return d.rule == rule; });
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

// In a sphere with its lamp off the middle, light is smooth. What is left out is 1e-3 of the mean square at most, where
// it was measured.
TEST_F(MeasuredRules, BandsThatSmoothLightDoesNotNeed) {
  scene::Scene scene = empty_scene();
  scene.materials[0] = diffuse(glm::vec3(.5f));
  add_sphere(scene, glm::vec3(0), 1, 16, 0, true);
  add_point_light(scene, {.1, .15, 0}, glm::vec3(1));
  const auto bench = measured(scene);
  const Texels with = bench->image("radiance-field.json", "bounce", options("4"));
  const int order = static_cast<int>(std::sqrt(bench->read("field.field.coefficients").width / 4.)) - 1;
  EXPECT_LT(order, 2) << "bands were left out";
  const Texels without = bench->image("radiance-field.json", "bounce", options("4", {"bands"}));
  EXPECT_LE(distance(with, without), std::sqrt(rules::bands_threshold));
}

// Of two rooms one is lit: the same number of probes stands where the light is, nearer to the truth.
TEST_F(MeasuredRules, BoundsOfWhatIsLitSpareProbesForIt) {
  scene::Scene scene = empty_scene();
  scene.materials[0] = diffuse(glm::vec3(.6f));
  add_box(scene, {-1, -1, -1}, {1, 1, 1}, 0, true);
  add_box(scene, {3, -1, -1}, {9, 1, 1}, 0, true);
  add_point_light(scene, {.5, .6, -.3}, glm::vec3(1));
  const auto bench = measured(scene);
  const Texels with = bench->image("radiance-field.json", "bounce", options("8"));
  EXPECT_TRUE(decided(*bench, "bounds"));
  const Texels without = bench->image("radiance-field.json", "bounce", options("8", {"bounds"}));
  const Texels truth =
      bench->image("reference.json", "bounce", {.size = {24, 24}, .set = {{"reference", "samples", "256"}}});
  EXPECT_LT(distance(with, truth), .8 * distance(without, truth));
}

}  // namespace
}  // namespace loom::test
