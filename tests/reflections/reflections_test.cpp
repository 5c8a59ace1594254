// Reflections and Refraction against closed forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"
#include "support/bench.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "voxelize": { "type": "Voxelize", "params": { "grid": 16 } },
    "lit": { "type": "Composite", "in": { "surface": "gbuffer.surface" } },
    "sky": { "type": "Reflections", "in": { "surface": "gbuffer.surface" }, "params": { "samples": 64 } },
    "seen": { "type": "Reflections", "in": { "surface": "gbuffer.surface", "picture": "lit.radiance" },
              "params": { "samples": 16 } },
    "all": { "type": "Reflections", "in": { "surface": "gbuffer.surface", "picture": "lit.radiance",
                                            "voxels": "voxelize.voxels" }, "params": { "samples": 16 } },
    "through": { "type": "Refraction", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels" } } },
  "outputs": { "image": "lit.radiance", "sky": "sky.radiance", "seen": "seen.radiance", "all": "all.radiance",
               "ends": "seen.ends", "through": "through.radiance" } })";

class ReflectionsTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// The scene with ggx surfaces, material `index` changed.
scene::Scene glossy(const SceneBuilder& builder, int index, const std::function<void(scene::Material&)>& change) {
  scene::Scene scene = builder.build();
  scene.surfaces = scene::SurfaceModel::ggx;
  change(scene.materials[static_cast<std::size_t>(index)]);
  return scene;
}

double schlick(double f0, double cosine) { return f0 + (1 - f0) * std::pow(1 - cosine, 5); }

// A mirror on the floor shows a lamp behind it where the mirrored ray meets it, times F, and nothing elsewhere. Within
// two pixels of the lamp's edge either may be.
TEST_F(ReflectionsTest, AMirrorShowsTheLampWhereItIs) {
  SceneBuilder builder;
  const glm::vec3 f0{.9F, .6F, .3F}, radiance{1, 2, 3};
  const int metal = builder.material(f0), lamp = builder.material(glm::vec3(0), radiance);
  builder.floor(glm::vec3(0), 2, metal);
  builder.quad({-.6F, .2F, -1}, {.6F, .2F, -1}, {.6F, .9F, -1}, {-.6F, .9F, -1}, lamp);
  Bench bench(*device_, glossy(builder, metal, [](scene::Material& m) {
    m.metallic = 1;
    m.roughness = 0;
  }));
  bench.look({.2, 1, 2.5}, {0, .2, -.5}, .4);
  bench.render(pipeline, {.size = {96, 96},
                          .set = {{"seen", "thickness", "0.01"}},
                          .requested = {"seen", "gbuffer.surface.depth", "gbuffer.surface.normal"}});
  const Texels seen = bench.read("seen"), depth = bench.read("gbuffer.surface.depth"),
               normal = bench.read("gbuffer.surface.normal");
  const glm::dvec3 eye(bench.camera().eye);
  int inside = 0, outside = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      if (depth.at(x, y).x == 0 || normal.at(x, y).y < .9) continue;
      const glm::dvec3 p = bench.position(x, y, depth.at(x, y).x), d = glm::normalize(p - eye);
      const glm::dvec3 l(d.x, -d.y, d.z);
      const double t = (-1 - p.z) / l.z;
      // How far within the lamp's edge the ray meets its plane.
      const double within = std::min(.6 - std::abs(p.x + t * l.x), .35 - std::abs(p.y + t * l.y - .55));
      const double pixel = 2 * std::tan(.4) / 96 * (glm::distance(eye, p) + t);
      if (std::abs(within) < 2 * pixel) continue;
      const bool met = within > 0 && t > 0;
      (met ? inside : outside) += 1;
      for (int c = 0; c < 3; ++c) {
        const double expected = met ? radiance[c] * schlick(f0[c], l.y) : 0;
        EXPECT_NEAR(seen.at(x, y)[c], expected, 2e-3 * expected) << x << ' ' << y << ' ' << c;
      }
    }
  }
  EXPECT_GT(inside, 200);
  EXPECT_GT(outside, 1000);
}

/// E(μ) = ∫ D·F·G₂/(4μ) dω for one channel, by the midpoint rule over the hemisphere of light.
double directional_albedo(double mu, double alpha, double f0) {
  const glm::dvec3 v(std::sqrt(1 - mu * mu), 0, mu);
  const auto lambda = [&](double c) { return .5 * (std::sqrt(1 + alpha * alpha * (1 / (c * c) - 1)) - 1); };
  const int steps = 600;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double z = (i + .5) / steps;
    for (int k = 0; k < steps; ++k) {
      const double phi = 2 * pi * (k + .5) / steps, r = std::sqrt(1 - z * z);
      const glm::dvec3 l(r * std::cos(phi), r * std::sin(phi), z), h = glm::normalize(v + l);
      const double d = alpha * alpha / (pi * std::pow(1 + (alpha * alpha - 1) * h.z * h.z, 2));
      sum += d * schlick(f0, glm::dot(v, h)) / (1 + lambda(mu) + lambda(z)) / (4 * mu);
    }
  }
  return sum * 2 * pi / (steps * steps);
}

// In uniform light a surface reflects L·E(μ), whatever brings the light: the sky, or the walls of a furnace by the
// picture and the voxels. 16,384 low-discrepancy rays leave less than half a percent; the seams of voxels as much
// again.
TEST_F(ReflectionsTest, UniformLightIsReflectedByTheDirectionalAlbedo) {
  for (const auto& [roughness, f0] : {std::pair(.5F, 1.F), std::pair(.8F, .6F), std::pair(0.F, 1.F)}) {
    const auto metal = [&](scene::Material& m) {
      m.metallic = 1;
      m.roughness = roughness;
    };
    const double mu = .5, alpha = static_cast<double>(roughness) * roughness;
    const double albedo = roughness > 0 ? directional_albedo(mu, alpha, f0) : schlick(f0, mu);
    const glm::dvec3 eye(0, .5, .5 * std::sqrt(3));

    SceneBuilder open;
    open.floor(glm::vec3(0), 1, open.material(glm::vec3(f0))).sky(glm::vec3(2));
    Bench under_sky(*device_, glossy(open, 0, metal));
    under_sky.look(eye, glm::dvec3(0), .01);
    EXPECT_NEAR(under_sky.image(pipeline, "sky", {.size = {16, 16}, .requested = {"sky"}}).mean().x, 2 * albedo,
                .01 * 2 * albedo)
        << roughness;

    SceneBuilder furnace;
    const int floor = furnace.material(glm::vec3(f0)), wall = furnace.material(glm::vec3(0), glm::vec3(3), true);
    furnace.box(glm::vec3(-1.03F, -.21F, -1.07F), glm::vec3(1.01F, 1.1F, 1.02F), wall);
    furnace.floor(glm::vec3(0), 1, floor);
    Bench inside(*device_, glossy(furnace, floor, metal));
    inside.look(eye, glm::dvec3(0), .01);
    EXPECT_NEAR(inside.image(pipeline, "all", {.size = {16, 16}, .requested = {"all"}}).mean().x, 3 * albedo,
                .02 * 3 * albedo)
        << roughness;
  }
}

// What has no gloss, and what is no glass, is nobody's to compute.
TEST_F(ReflectionsTest, MatteSurfacesHaveNone) {
  SceneBuilder builder;
  builder.floor(glm::vec3(0), 1, builder.material(glm::vec3(.5F))).sky(glm::vec3(1));
  Bench bench(*device_, builder.build());
  bench.render(pipeline, {.size = {8, 8}});
  EXPECT_TRUE(bench.absent("all"));
  EXPECT_TRUE(bench.absent("through"));
}

/// Fresnel's reflectance of unpolarised light, from the angles.
double fresnel(double cosine, double ior) {
  const double inner = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * inner) / (cosine + ior * inner);
  const double p = (inner - ior * cosine) / (inner + ior * cosine);
  return .5 * (s * s + p * p);
}

// Through a slab of glass a lamp below is seen shifted by T(tanθ − tanθ'), dimmed to (1−R)²: where Snell's law takes
// the ray, and nowhere else. Within a tenth of a metre of the lamp's edge either may be.
TEST_F(ReflectionsTest, ASlabShiftsAndDims) {
  const double thick = .5, ior = 1.5;
  SceneBuilder builder;
  const int glass = builder.material(glm::vec3(1)), lamp = builder.material(glm::vec3(0), glm::vec3(2));
  builder.box({-2, -.5F, -2}, {2, 0, 2}, glass);
  builder.quad({-3, -1, 2}, {0, -1, 2}, {0, -1, -2}, {-3, -1, -2}, lamp);
  Bench bench(*device_, glossy(builder, glass, [](scene::Material& m) {
    m.roughness = 0;
    m.transmission = 1;
    m.ior = 1.5F;
  }));
  bench.look({2.2, 1.2, 0}, {.3, 0, 0}, .3);
  bench.render(pipeline, {.size = {64, 64},
                          .set = {{"through", "bounces", "1"}},
                          .requested = {"through", "gbuffer.surface.depth", "gbuffer.surface.normal"}});
  const Texels seen = bench.read("through"), depth = bench.read("gbuffer.surface.depth"),
               normal = bench.read("gbuffer.surface.normal");
  const glm::dvec3 eye(bench.camera().eye);
  int lit = 0, dark = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (depth.at(x, y).x == 0 || normal.at(x, y).y < .9) continue;
      const glm::dvec3 p = bench.position(x, y, depth.at(x, y).x), d = glm::normalize(p - eye);
      const glm::dvec3 inner(d.x / ior, -std::sqrt(1 - (1 - d.y * d.y) / (ior * ior)), d.z / ior);
      const glm::dvec3 out = p + thick / -inner.y * inner, met = out + .5 / -d.y * d;
      // Out through the bottom, and onto the lamp or beside it.
      if (std::abs(out.x) > 1.9 || std::abs(out.z) > 1.9 || std::abs(met.x) < .1 || met.x < -2.9 ||
          std::abs(met.z) > 1.9)
        continue;
      const double through = 1 - fresnel(-d.y, ior);
      const double expected = met.x < 0 ? 2 * through * through : 0;
      (met.x < 0 ? lit : dark) += 1;
      EXPECT_NEAR(seen.at(x, y).x, expected, .01 * expected) << x << ' ' << y;
    }
  }
  EXPECT_GT(lit, 200);
  EXPECT_GT(dark, 200);
}

// Under a uniform sky glass shows L(1−R) in all, once everything that is reflected within has left.
TEST_F(ReflectionsTest, NothingIsLostWithinGlass) {
  SceneBuilder builder;
  builder.box({-1, -.5F, -1}, {1, 0, 1}, builder.material(glm::vec3(1))).sky(glm::vec3(2));
  Bench bench(*device_, glossy(builder, 0, [](scene::Material& m) {
    m.roughness = 0;
    m.transmission = 1;
    m.ior = 1.7F;
  }));
  bench.look({0, 1, 1}, {0, 0, 0}, .01);
  const std::string bare = R"({ "passes": { "gbuffer": { "type": "GBuffer" },
      "through": { "type": "Refraction", "in": { "surface": "gbuffer.surface" }, "params": { "bounces": 12 } } },
    "outputs": { "image": "through.radiance" } })";
  const double expected = 2 * (1 - fresnel(std::sqrt(.5), 1.7));
  EXPECT_NEAR(bench.image(bare, "image", {.size = {4, 4}}).mean().x, expected, 1e-3 * expected);
}

}  // namespace
}  // namespace loom::test
