// DirectSpecular against f_s·I⟨n,l⟩/r² in double, and Composite's coat against the energy that is left under it.
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "reference/film.h"
#include "reference/ggx.h"
#include "reference/path_tracer.h"
#include "support/bench.h"
#include "support/scene_builders.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" }, "rsm": { "type": "RSM", "params": { "shadow_size": 512 } },
    "direct": { "type": "DirectLight", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } },
    "gloss": { "type": "DirectSpecular", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } },
    "composite": { "type": "Composite", "in": { "surface": "gbuffer.surface", "direct": "direct.irradiance",
                   "specular": "gloss.radiance" } } },
  "outputs": { "image": "composite.radiance", "gloss": "gloss.radiance", "direct": "direct.irradiance" } })";

scene::Material material(glm::vec3 base, float metallic, float roughness) {
  scene::Material m;
  m.base_color = glm::vec4(base, 1);
  m.metallic = metallic;
  m.roughness = roughness;
  return m;
}

/// D·F·G₂/(4 μ_v μ_l) by the formulas of Walter, Heitz and Schlick.
double brdf(glm::dvec3 n, glm::dvec3 v, glm::dvec3 l, double alpha, double f0) {
  const glm::dvec3 h = glm::normalize(v + l);
  const double nh = glm::dot(n, h), nv = glm::dot(n, v), nl = glm::dot(n, l), a2 = alpha * alpha;
  const double d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const double g2 = 2 * nl * nv / (nv * std::sqrt(a2 + (1 - a2) * nl * nl) + nl * std::sqrt(a2 + (1 - a2) * nv * nv));
  return d * g2 * (f0 + (1 - f0) * std::pow(1 - glm::dot(v, h), 5)) / (4 * nv * nl);
}

class DirectSpecular : public GlTest, public ::testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

TEST_P(DirectSpecular, IsTheBrdfTimesTheLight) {
  SceneBuilder scene;
  const glm::dvec3 lamp(.5, 2, -.3), base(1, .5, .25);
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point(glm::vec3(lamp), glm::vec3(4));
  scene::Scene built = scene.build();
  built.surfaces = scene::SurfaceModel::ggx;
  for (scene::Material& m : built.materials) m = material(glm::vec3(base), 1, .5F);
  Bench bench(*device_, built);
  bench.look_down(2);
  const Texels l = bench.image(pipeline, "gloss", {.size = {64, 64}, .set = {{"gloss", "shadow", GetParam()}}});
  double brightest = 0;
  for (int y = 0; y < l.height; ++y) {
    for (int x = 0; x < l.width; ++x) {
      const glm::dvec3 way = lamp - bench.position(x, y, 10);
      const double r = glm::length(way);
      const glm::dvec3 up(0, 1, 0);
      for (int c = 0; c < 3; ++c) {
        const double expected = brdf(up, up, way / r, .25, base[c]) * 4 * way.y / (r * r * r);
        brightest = std::max(brightest, expected);
        // α and F₀ are exact as half floats; what is left is rounding.
        ASSERT_NEAR(l.at(x, y)[c], expected, 1e-3 * expected + 1e-6) << x << ' ' << y << ' ' << c;
      }
    }
  }
  EXPECT_GT(brightest, 1);
}
INSTANTIATE_TEST_SUITE_P(Shadow, DirectSpecular, ::testing::Values("none", "map", "ray"),
                         [](const auto& parameter) { return parameter.param; });

// A plate |x|, |z| ≤ .5 at half the height of the light throws a shadow |x|, |z| ≤ 1.
TEST_P(DirectSpecular, AShadowTakesItAway) {
  const bool shadowed = GetParam() != "none";
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  scene.floor(glm::vec3(0), 10, grey).floor({0, 1, 0}, .5F, grey).point({0, 2, 0}, glm::vec3(4));
  scene::Scene built = scene.build();
  built.surfaces = scene::SurfaceModel::ggx;
  for (scene::Material& m : built.materials) m = material(glm::vec3(1), 1, .5F);
  Bench bench(*device_, built);
  bench.look_down(2);
  const Texels l = bench.image(pipeline, "gloss", {.size = {64, 64}, .set = {{"gloss", "shadow", GetParam()}}});
  for (int x = 0; x < l.width; ++x) {
    const double across = std::abs(bench.position(x, 32, 10).x);
    if (across > .55 && across < .95) {
      ASSERT_EQ(l.at(x, 32).x == 0, shadowed) << across;
    } else if (across > 1.05) {
      ASSERT_GT(l.at(x, 32).x, 0) << across;
    }
  }
}

using Coat = DirectSpecular;

// Seen aslant, where G₂ and F matter: the mean over the picture against the path tracer's layer.
TEST_F(Coat, AgreesWithThePathTracer) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  scene.floor(glm::vec3(0), 10, grey).point({-.5F, 2, -1.5F}, glm::vec3(4));
  scene::Scene built = scene.build();
  built.surfaces = scene::SurfaceModel::ggx;
  for (scene::Material& m : built.materials) m = material({1, .5F, .25F}, .75F, .5F);
  const scene::Camera camera = look_at({0, 2.5, 3}, {0, 0, 0});  // the floor fills the picture
  const glm::ivec2 size(64);
  Bench bench(*device_, built);
  bench.look(camera);
  const glm::vec4 ours = bench.image(pipeline, "gloss", {.size = size, .set = {{"gloss", "shadow", "ray"}}}).mean();
  const reference::Options options{.bounces = 0};
  const reference::PathTracer tracer(built, camera.eye, options);
  reference::Film film(size, {}, 0);
  tracer.accumulate(film, reference::view_of(camera, built, size, camera.eye), 16);
  glm::dvec3 theirs(0);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) theirs += reference::Film::mean(film.pixel(x, y), reference::Layer::specular);
  theirs /= size.x * size.y;
  // One sample at a pixel's centre against its area.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ours[c], theirs[c], 2e-3 * theirs[c]);
  EXPECT_GT(theirs[0], .01);
}

TEST_F(Coat, LeavesTheRestToDiffuseLight) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point({.5F, 2, -.3F}, glm::vec3(4));
  scene::Scene built = scene.build();
  built.surfaces = scene::SurfaceModel::ggx;
  for (scene::Material& m : built.materials) m = material(glm::vec3(.5F), 0, .5F);
  Bench bench(*device_, built);
  bench.look_down(2);
  const Texels all = bench.image(pipeline, "image", {.size = {32, 32}});
  const Texels gloss = bench.image(pipeline, "gloss", {.size = {32, 32}});
  const Texels e = bench.image(pipeline, "direct", {.size = {32, 32}});
  const double under = 1 - reference::ggx_albedo(1, .25F, glm::vec3(.04F)).x;
  for (int y = 0; y < all.height; ++y) {
    for (int x = 0; x < all.width; ++x) {
      const double expected = gloss.at(x, y).x + .5 / pi * under * e.at(x, y).x;
      ASSERT_NEAR(all.at(x, y).x, expected, 1e-4 * expected);
    }
  }
}

// Of matte surfaces, and where all are diffuse, there is nothing to reflect: the wire carries nothing, no bit moves.
TEST_F(Coat, MatteSurfacesHaveNone) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 10, scene.material(glm::vec3(.5))).point({.5F, 2, -.3F}, glm::vec3(4));
  scene::Scene built = scene.build();
  Bench diffuse(*device_, built);
  built.surfaces = scene::SurfaceModel::ggx;
  Bench matte(*device_, built);
  diffuse.look_down(2);
  matte.look_down(2);
  const Texels a = diffuse.image(pipeline, "image", {.size = {32, 32}});
  const Texels b = matte.image(pipeline, "image", {.size = {32, 32}});
  for (int i = 0; i < 32 * 32; ++i) ASSERT_EQ(a.at(i % 32, i / 32), b.at(i % 32, i / 32));
  matte.render(pipeline, {.size = {32, 32}});
  EXPECT_TRUE(matte.absent("gloss"));
}

}  // namespace
}  // namespace loom::test
