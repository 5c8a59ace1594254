// A sky of two bands, L(ω) = a + b⟨axis,ω⟩, over an unblocked plane: E = πa + 2π/3·b⟨axis,n⟩, by every pass that brings
// straight light of the sky; and what it lights by one reflection.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/sky.h"
#include "support/bench.h"
#include "support/sky_images.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;
const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 1, -.5)), slope(.9, .5, -.6);

class SkyImages : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  /// A black plane through the origin, seen straight from above it.
  static scene::Scene plane(const scene::SkyImage& sky) {
    SceneBuilder builder;
    builder.floor(glm::vec3(0), 1, builder.material(glm::vec3(0)));
    scene::Scene scene = builder.build();
    scene::set_sky(scene, sky);
    return scene;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

std::string pipeline(const std::string& passes, const std::string& result) {
  return R"({"passes": {"gbuffer": {"type": "GBuffer"}, "voxelize": {"type": "Voxelize", "params": {"grid": 16}}, )" +
         passes + R"(}, "outputs": {"image": ")" + result + R"("}})";
}

struct Way {
  std::string name, passes;
  double rays;  ///< N: each averages over 2π/N sr
};

// Filtering over a variance σ² along each axis takes σ² of band 1 (l(l+1)/2 = 1), σ² = Ω/4π = 1/(2N) with 2π/N a ray;
// between two levels of the image up to a quarter more. 64 low-discrepancy rays add their own error, 1/N of what
// varies.
TEST_F(SkyImages, OverAPlane) {
  const std::vector<Way> ways{
      {"AreaLight", R"("e": {"type": "AreaLight", "in": {"surface": "gbuffer.surface"}, "params": {"samples": 64}})",
       64},
      {"rays", R"("e": {"type": "RayMarch", "in": {"surface": "gbuffer.surface", "voxels": "voxelize.voxels"},
          "params": {"emitter": true, "rays": 64}})",
       64},
      {"cones", R"("e": {"type": "RayMarch", "in": {"surface": "gbuffer.surface", "voxels": "voxelize.voxels"},
          "params": {"emitter": true, "method": "cones", "cones": 64}})",
       64}};
  Bench bench(*device_, plane(sky_of_two_bands(1, slope, axis)));
  bench.look_down(.5, 2);
  const glm::dvec3 expected = irradiance_of_two_bands(1, slope, axis, {0, 1, 0});
  for (const Way& way : ways) {
    const Texels e = bench.image(pipeline(way.passes, "e.irradiance"), "image", {.size = {8, 8}});
    for (int c = 0; c < 3; ++c) {
      const double band = std::abs(2 * pi / 3 * slope[c] * axis.y);
      EXPECT_NEAR(e.mean()[c], expected[c], (1.25 / (2 * way.rays) + 2 / way.rays) * band + 1e-3 * pi)
          << way.name << ' ' << c;
    }
  }
}

// A wall that faces +X under a sky that is bright towards +Z: dark to it as it lies, as bright as can be once +Z has
// turned to +X.
TEST_F(SkyImages, TurnAboutTheUpwardAxis) {
  SceneBuilder builder;
  builder.quad({0, -1, 1}, {0, -1, -1}, {0, 1, -1}, {0, 1, 1}, builder.material(glm::vec3(0)));
  for (const auto& [turn, facing] : {std::pair{0., 0.}, {pi / 2, 1.}, {-pi / 2, -1.}}) {
    scene::Scene scene = builder.build();
    scene::SkyImage sky = sky_of_two_bands(1, glm::dvec3(1), {0, 0, 1});
    sky.rotation_rad = turn;
    scene::set_sky(scene, sky);
    Bench bench(*device_, scene);
    bench.look({3, 0, 0}, {0, 0, 0}, .05);
    const Texels e = bench.image(
        pipeline(R"("e": {"type": "AreaLight", "in": {"surface": "gbuffer.surface"}, "params": {"samples": 64}})",
                 "e.irradiance"),
        "image", {.size = {8, 8}});
    EXPECT_NEAR(e.mean().x, pi + 2 * pi / 3 * facing, .04 * 2 * pi / 3 + 1e-3 * pi) << turn;
  }
}

// The background of Composite: L(ω) along each pixel's ray.
TEST_F(SkyImages, AreTheBackground) {
  Bench bench(*device_, plane(sky_of_two_bands(1, glm::dvec3(.5), {0, 0, -1})));
  const auto seen = [&](glm::dvec3 towards) {
    bench.look({0, 5, 0}, glm::dvec3(0, 5, 0) + towards, .02,
               towards.y == 0 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0));
    const char* const composite = R"({"passes": {"gbuffer": {"type": "GBuffer"},
      "l": {"type": "Composite", "in": {"surface": "gbuffer.surface"}}}, "outputs": {"image": "l.radiance"}})";
    return bench.image(composite, "image", {.size = {8, 8}}).mean().x;
  };
  EXPECT_NEAR(seen({0, 0, -1}), 1.5, 2e-3);
  EXPECT_NEAR(seen({0, 0, 1}), .5, 2e-3);
  EXPECT_NEAR(seen({1, 0, 0}), 1, 2e-3);
  EXPECT_NEAR(seen({0, 1, 0}), 1, 2e-3);
}

// What a floor sends up to a plate goes with the floor's own irradiance, E/πa = 1 + 2/3·b/a under a sky that is bright
// above: whatever a method makes of the geometry falls out of the quotient to the constant sky. Looking the other way
// would give a fifth. Rays have a filter of 1/(2N) of band 1 and an error of 1/N each, 64 and more of them.
TEST_F(SkyImages, ReflectedOnce) {
  SceneBuilder builder;
  builder.floor({.01F, 0, .02F}, 2, builder.material(glm::vec3(.5F)));
  const int black = builder.material(glm::vec3(0));
  builder.quad({-.25F, 1.5F, -.25F}, {.25F, 1.5F, -.25F}, {.25F, 1.5F, .25F}, {-.25F, 1.5F, .25F}, black);
  const auto received = [&](const scene::SkyImage& sky, const std::string& pipeline, std::vector<graph::Override> set) {
    scene::Scene scene = builder.build();
    scene::set_sky(scene, sky);
    Bench bench(*device_, scene);
    bench.look({.02, .5, .03}, {.02, 1.5, .03}, .1, {1, 0, 0});
    return bench.image(pipeline, "bounce", {.size = {8, 8}, .set = std::move(set), .requested = {"bounce"}}).mean().x;
  };
  const std::vector<std::pair<std::string, std::vector<graph::Override>>> ways{
      {"lpv.json", {{"inject", "emission_rays", "4096"}, {"inject", "grid", "16"}}},
      {"instant-radiosity.json", {{"vpls", "paths", "512"}}},
      {"radiance-field.json", {{"field", "probes", "4"}, {"field", "emitter_rays", "64"}}},
      {"ray-march.json", {{"voxelize", "grid", "16"}, {"voxelize", "rays", "64"}}}};
  for (const auto& [pipeline, set] : ways) {
    const double plain = received(sky_of_two_bands(1, glm::dvec3(0), {0, 1, 0}), pipeline, set);
    const double bright = received(sky_of_two_bands(1, glm::dvec3(1), {0, 1, 0}), pipeline, set);
    ASSERT_GT(plain, 0) << pipeline;
    // No camera and no light sees the floor: nothing blocks in LPV's grid, and light of its underside comes up through
    // it.
    if (pipeline == "lpv.json") {
      EXPECT_GT(bright / plain, 1);
    } else {
      EXPECT_NEAR(bright / plain, 5. / 3, .03) << pipeline;
    }
  }
}

}  // namespace
}  // namespace loom::test
