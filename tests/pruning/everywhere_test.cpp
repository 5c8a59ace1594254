// What a rule leaves out does not show: every rule over shipped pipelines and small scenes, each of which needs
// something that the others do not. Most rules keep the bits; the others keep within their bound, which is asserted
// here.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "loom/rules.h"
#include "picture_distance.h"
#include "scene/load.h"
#include "support/bench.h"

namespace loom::test {
namespace {

/// A closed room with a block, lit by a spot; what is in it is the caller's.
scene::Scene room(glm::vec3 albedo, glm::vec3 light) {
  SceneBuilder scene;
  const int wall = scene.material(albedo);
  scene.quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, wall);
  scene.quad({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, wall);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, wall);
  scene.quad({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1}, wall);
  scene.quad({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1}, wall);
  scene.box({-.5f, 0, -.5f}, {0, .8f, 0}, wall);
  return scene.spot({.2f, 1.9f, .1f}, {-.1f, -1, -.2f}, light, .4, .7).build();
}

scene::Scene grey() { return room(glm::vec3(.5f), glm::vec3(6)); }
scene::Scene dark_grey() { return room(glm::vec3(.05f), glm::vec3(6)); }
scene::Scene coloured() { return room({.7f, .3f, .2f}, {6, 5, 4}); }
scene::Scene emissive() {
  scene::Scene scene = grey();
  scene.materials.back().emissive = {.2f, .2f, .2f};
  return scene;
}
scene::Scene masked() {
  scene::Scene scene = coloured();
  scene::Material leaf = scene.materials.back();
  leaf.alpha = scene::AlphaMode::mask;
  leaf.base_color.a = .2f;  // below the cutoff: the block is not there
  scene.materials.push_back(leaf);
  scene.meshes.back().primitives.back().material = static_cast<int>(scene.materials.size()) - 1;
  return scene;
}
/// The whole room slides: node 0 carries every mesh that the builder made.
scene::Scene moving() {
  scene::Scene scene = coloured();
  scene::Channel slide{.node = scene.instances.front().node, .path = scene::Path::translation};
  slide.times = {0, 1};
  slide.values = {glm::vec4(0), glm::vec4(.25f, 0, 0, 0)};
  scene.animations.push_back({.name = "slide", .channels = {slide}});
  return scene;
}

struct NamedScene {
  std::string name;
  scene::Scene (*make)();
};
const std::vector<NamedScene>& scenes() {
  static const std::vector<NamedScene> all = {{"grey", grey},         {"dark grey", dark_grey}, {"coloured", coloured},
                                              {"emissive", emissive}, {"masked", masked},       {"moving", moving}};
  return all;
}

std::vector<std::string> shipped_pipelines() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(LOOM_SOURCE_DIR "/pipelines"))
    if (entry.path().extension() == ".json" && entry.path().stem() != "reference")
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// How far rules may move the picture: the root of its mean square, as a share of that of the picture. Those that are
/// not here keep every bit.
using RuleBounds = std::map<std::string, double, std::less<>>;

/// `bounces` keeps n orders, ρⁿ⁺¹ < 10⁻³. Where light arrives straight, ρⁿ⁺¹ of all light is missing; a pixel that none
/// reaches straight has Σ ρᵏ over k ≥ 1, and lacks ρⁿ of it.
RuleBounds bounds_of(const SceneFacts& facts) {
  const int kept = rules::bounces(Ports{{1, 1}, {}}, facts.max_albedo);
  return {{"bounces", std::pow(facts.max_albedo, kept)}, {"iterations", .02}};
}

class Everywhere : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }

  static BenchOptions small() {
    BenchOptions options{.size = {24, 20}, .requested = {"hdr"}, .frames = 2};
    for (const auto& [pass, param, value] : std::initializer_list<graph::Override>{{"rsm", "size", "16"},
                                                                                   {"rsm", "shadow_size", "128"},
                                                                                   {"voxelize", "grid", "10"},
                                                                                   {"vpls", "paths", "64"},
                                                                                   {"transfer", "points", "3"},
                                                                                   {"transfer", "paths", "64"},
                                                                                   {"field", "probes", "3"}}) {
      options.set.push_back({pass, param, value});
    }
    return options;
  }

  Texels hdr(Bench& bench, const std::string& pipeline, BenchOptions options) {
    // Only settings of passes that the pipeline has.
    const auto text = [&] {
      const auto result =
          graph::compile_file(LOOM_SOURCE_DIR "/pipelines/" + pipeline, all_passes(), bench.facts(), {});
      std::set<std::string> passes;
      for (const auto& pass : result.graph->passes) passes.insert(pass.name);
      return passes;
    }();
    std::erase_if(options.set, [&](const graph::Override& set) { return text.count(set.pass) == 0; });
    bench.render(pipeline, options);
    return bench.absent("hdr") ? Texels{} : bench.read("hdr");
  }

  std::set<std::string> deciding(const Bench& bench) {
    std::set<std::string> rules;
    for (const Decision& decision : bench.renderer().graph().decisions) rules.insert(decision.rule);
    return rules;
  }

  void check(Bench& bench, const std::string& pipeline, bool each_rule) {
    const Texels pruned = hdr(bench, pipeline, small());
    const std::set<std::string> rules = deciding(bench);
    const RuleBounds bounds = bounds_of(bench.facts());
    double bound = 0;
    for (const std::string& rule : rules)
      if (const auto found = bounds.find(rule); found != bounds.end()) bound += found->second;
    BenchOptions off = small();
    off.prune = false;
    const Texels all = hdr(bench, pipeline, off);
    ASSERT_EQ(pruned.values.size(), all.values.size());
    EXPECT_TRUE(bench.renderer().kept_passes().empty());
    EXPECT_LE(distance(pruned, all), bound) << "all rules together";
    EXPECT_TRUE(bound > 0 || pruned == all) << "the bits differ, by " << distance(pruned, all);
    if (!each_rule) return;
    for (const std::string& rule : rules) {
      BenchOptions without = small();
      without.disabled_rules = {rule};
      const Texels image = hdr(bench, pipeline, without);
      const auto found = bounds.find(rule);
      if (found == bounds.end()) {
        EXPECT_TRUE(image == pruned) << rule << " changes the bits, by " << distance(image, pruned);
      } else {
        EXPECT_LE(distance(pruned, image), found->second) << rule;
      }
      EXPECT_EQ(deciding(bench).count(rule), 0u) << rule << " decides although it is off";
    }
  }

  std::unique_ptr<gpu::CachingDevice> device_;
};

TEST_F(Everywhere, NoRuleMovesThePictureBeyondItsBound) {
  const bool thorough = std::getenv("LOOM_SLOW_TESTS") != nullptr;
  const std::vector<std::string> few{"lpv-fast.json", "lpv-voxel-fast.json", "ray-march-fast.json",
                                     "radiance-field-fast.json"};
  const std::set<std::string> fast_scenes{"grey", "emissive"};
  for (const NamedScene& named : scenes()) {
    if (!thorough && fast_scenes.count(named.name) == 0) continue;
    Bench bench(*device_, named.make());
    bench.look({0, 1, 3.2}, {0, 1, 0}, .4);
    for (const std::string& pipeline : thorough ? shipped_pipelines() : few) {
      SCOPED_TRACE(named.name + ", " + pipeline);
      check(bench, pipeline, thorough);
    }
  }
}

}  // namespace
}  // namespace loom::test
