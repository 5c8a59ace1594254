// The volumes that a pipeline's voxels take: what somebody reads and no more, in as many channels as the scene has.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "graph/compile/compile.h"
#include "graph/compile/export.h"
#include "loom/grid.h"
#include "scene/load.h"
#include "support/bench.h"

namespace loom::test {
namespace {

const char* const one_bounce = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 16 } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels" } } },
  "outputs": { "image": "march.irradiance" } })";
const char* const all_bounces = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 16, "rays": 8 } },
    "radiosity": { "type": "Radiosity", "in": { "voxels": "voxelize.voxels" }, "params": { "bounces": 3 } },
    "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels",
                                           "light": "radiosity.light" }, "params": { "rays": 8 } } },
  "outputs": { "image": "march.irradiance" } })";

scene::Scene lit_corner(glm::vec3 albedo, glm::vec3 light) {
  SceneBuilder scene;
  const int wall = scene.material(albedo);
  scene.floor(glm::vec3(0), 1, wall);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, wall);
  return scene.point({.2F, 1.5F, .3F}, light).build();
}

/// Bytes a cell of each volume of the voxels, as `loom plan --json` tells them.
std::map<std::string, double> layout(const char* pipeline, const scene::Scene& scene,
                                     const graph::CompileOptions& options = {}) {
  const SceneFacts facts = scene::compute_facts(scene);
  const auto compiled = graph::compile_text(pipeline, "test.json", all_passes(), facts, options);
  if (!compiled.graph) throw BadInput(compiled.diagnostics);
  const interop::Grid grid = fit_grid({facts.bounds_min, facts.bounds_max}, 16);
  const double cells = static_cast<double>(grid.cells.x) * grid.cells.y * grid.cells.z;
  const std::string prefix = "voxelize.voxels.";
  std::map<std::string, double> volumes;
  const auto plan = nlohmann::json::parse(graph::plan_json(*compiled.graph, facts));
  for (const auto& resource : plan.at("resources")) {
    const auto name = resource.at("name").get<std::string>();
    if (name.rfind(prefix, 0) == 0) volumes[name.substr(prefix.size())] = resource.at("bytes").get<double>() / cells;
  }
  return volumes;
}

using Layout = std::map<std::string, double>;

TEST(LayoutTest, VolumesAreThoseThatSomebodyReads) {
  const scene::Scene scene = lit_corner({.8F, .4F, .2F}, {1, 2, 3});
  graph::CompileOptions occlusion;
  occlusion.requested = {"voxelize.voxels.coverage"};
  EXPECT_EQ(layout(one_bounce, scene, occlusion), (Layout{{"coverage", 8}, {"plane", 24}, {"extent", 12}}));
  EXPECT_EQ(layout(one_bounce, scene),
            (Layout{{"coverage", 8}, {"plane", 24}, {"extent", 12}, {"centroid", 48}, {"radiance", 96}}));
  EXPECT_EQ(
      layout(all_bounces, scene),
      (Layout{{"coverage", 8}, {"plane", 24}, {"extent", 12}, {"centroid", 48}, {"albedo", 48}, {"radiance", 96}}));
  graph::CompileOptions luminance;
  luminance.overrides = {{"voxelize", "channels", "luminance"}};
  EXPECT_EQ(layout(one_bounce, scene, luminance),
            (Layout{{"coverage", 8}, {"plane", 24}, {"extent", 12}, {"centroid", 48}, {"radiance", 24}}));
  EXPECT_EQ(
      layout(all_bounces, scene, luminance),
      (Layout{{"coverage", 8}, {"plane", 24}, {"extent", 12}, {"centroid", 48}, {"albedo", 24}, {"radiance", 24}}));
}

class ChannelsTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

// Without colour in the scene one channel is chosen by itself, and holds what three would.
TEST_F(ChannelsTest, AGreySceneTakesOneChannelAndLosesNothing) {
  const scene::Scene scene = lit_corner(glm::vec3(.6F), glm::vec3(2));
  graph::CompileOptions colour;
  colour.prune = false;
  EXPECT_EQ(layout(all_bounces, scene).at("radiance"), 24);
  EXPECT_EQ(layout(all_bounces, scene, colour).at("radiance"), 96);
  Bench bench(*device_, scene);
  bench.look({.3, .8, 2}, {0, .5, -1}, .5);
  const Texels one = bench.image(all_bounces, "image", {.size = {16, 16}});
  const Texels three = bench.image(all_bounces, "image", {.size = {16, 16}, .prune = false});
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    // Weights of luminance add up to 1 within rounding, and albedo is a half float.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(one.values[i][c], three.values[i][c], 2e-3 * three.values[i][c] + 1e-6);
  }
}

// In a coloured one the luminance of straight light, once reflected, is that of the coloured volumes: ρ and E are
// reduced to luminance one by one, so that it differs by what their product does.
TEST_F(ChannelsTest, LuminanceOfAWhiteLightOnColouredWalls) {
  const glm::vec3 albedo{.8F, .4F, .2F};
  Bench bench(*device_, lit_corner(albedo, glm::vec3(2)));
  bench.look({.3, .8, 2}, {0, .5, -1}, .5);
  const Texels grey =
      bench.image(one_bounce, "image", {.size = {16, 16}, .set = {{"voxelize", "channels", "luminance"}}});
  const Texels colour = bench.image(one_bounce, "image", {.size = {16, 16}});
  const auto luminance = [](glm::vec4 c) { return .2126 * c.r + .7152 * c.g + .0722 * c.b; };
  EXPECT_GT(colour.mean().r, 2 * colour.mean().b);
  EXPECT_EQ(grey.mean().r, grey.mean().b);
  EXPECT_NEAR(grey.mean().g, luminance(colour.mean()), 2e-3 * luminance(colour.mean()));
}

}  // namespace
}  // namespace loom::test
