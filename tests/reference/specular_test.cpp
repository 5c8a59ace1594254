// Surfaces that are more than diffuse: what has a closed form, and what must hold whatever the form.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "reference/bsdf.h"
#include "reference/ggx.h"
#include "reference/scenes.h"
#include "support/hand_scene.h"
#include "support/scene_builders.h"

namespace loom::reference::test {
namespace {

constexpr double pi = std::numbers::pi;

/// A unit vector in the plane y = 0, at this cosine to z.
glm::vec3 at_cosine(float mu) { return {std::sqrt(1 - mu * mu), 0, mu}; }

SurfacePoint glossy(float roughness, const glm::vec3& f0, const glm::vec3& albedo = glm::vec3(0)) {
  SurfacePoint s;
  s.geometric_normal = s.normal = {0, 0, 1};
  s.albedo = albedo;
  s.glossy = true;
  s.alpha = roughness * roughness;
  s.f0 = f0;
  return s;
}

/// ∫ D·value dh over microfacet normals h by the midpoint rule. With tan θ = α·√(1−w²)/w, D cos θ dh = 2w dw dφ/2π for
/// GGX, and w falls as the cosine does, by which it is divided.
template <class Value>
double over_normals(float alpha, const Value& value) {
  constexpr int side = 400;
  double sum = 0;
  for (int i = 0; i < side; ++i) {
    const double w = (i + .5) / side;
    const double tangent = static_cast<double>(alpha) * std::sqrt(1 - w * w) / w;
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    for (int j = 0; j < side; ++j) {
      const double phi = 2 * pi * (j + .5) / side;
      const glm::dvec3 h(tangent * cosine * std::cos(phi), tangent * cosine * std::sin(phi), cosine);
      sum += value(h) * 2 * w / cosine;
    }
  }
  return sum / (side * side);
}

// ∫ G₁ D ⟨v,h⟩₊/v.z dh = 1: what the density of visible normals must integrate to.
TEST(Ggx, DensityOfSamplesIntegratesToOne) {
  for (const float roughness : {.3F, .6F, 1.F}) {
    for (const float mu : {.15F, .5F, .95F}) {
      const float alpha = roughness * roughness;
      const glm::vec3 v = at_cosine(mu);
      // Per direction of light; a normal's share of directions is 4⟨v,h⟩ times its own. D(h) cancels against the
      // mean's.
      const double sum = over_normals(alpha, [&](const glm::dvec3& h) {
        const auto seen = static_cast<float>(glm::dot(h, glm::dvec3(v)));
        if (seen <= 0) return 0.;
        const double density = ggx_sample_density(v, glm::vec3(h), alpha) * 4 * seen;
        return density / ggx_distribution(glm::vec3(h), alpha);
      });
      EXPECT_NEAR(sum, 1, 2e-3) << roughness << ' ' << mu;
    }
  }
}

// The table against the integral of f_s⟨n,l⟩ over light, by a rule that knows nothing of how samples are drawn; and the
// mean of samples against both. Single scattering loses light, it never makes any.
TEST(Ggx, TableIsTheIntegralAndTheMeanOfSamples) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const float roughness : {.25F, .5F, .8F, 1.F}) {
    for (const float mu : {.1F, .35F, .7F, 1.F}) {
      for (const float f0 : {1.F, .04F}) {
        const float alpha = roughness * roughness;
        const glm::vec3 v = at_cosine(mu);
        const double integral = over_normals(alpha, [&](const glm::dvec3& h) {
          const double seen = glm::dot(h, glm::dvec3(v));
          const double out = 2 * seen * h.z - v.z;
          if (seen <= 0 || out <= 0) return 0.;
          // f_s cos dω = F·G₂/(4 μ_v cos)·cos · 4⟨v,h⟩ D dh
          const double g2 = ggx_shadowing(mu, static_cast<float>(out), alpha);
          return fresnel_schlick(static_cast<float>(seen), glm::vec3(f0)).x * g2 * seen / mu;
        });
        const double table = ggx_albedo(mu, alpha, glm::vec3(f0)).x;
        EXPECT_NEAR(table, integral, .008) << roughness << ' ' << mu << ' ' << f0;
        EXPECT_LE(table, 1.0001F);
        EXPECT_LE(integral, 1.0001);

        const SurfacePoint point = glossy(roughness, glm::vec3(f0));
        const Bsdf bsdf(point, v);
        double sum = 0;
        constexpr int count = 20000;
        for (int i = 0; i < count; ++i) {
          const glm::vec2 u(uniform(random), uniform(random));
          const BsdfSample s = bsdf.sample(Lobes::specular, u, {uniform(random), uniform(random)});
          ASSERT_LE(s.weight.x, 1.0001F);
          if (s.density > 0) sum += s.weight.x;
        }
        EXPECT_NEAR(sum / count, integral, 4 * .5 / std::sqrt(count)) << roughness << ' ' << mu << ' ' << f0;
      }
    }
  }
}

TEST(Bsdf, IsReciprocal) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(.05F, 1);
  for (int i = 0; i < 200; ++i) {
    const float metallic = uniform(random);
    const SurfacePoint s = glossy(uniform(random), glm::vec3(.04F + .9F * metallic), glm::vec3(1 - metallic));
    const auto direction = [&] {
      return glm::normalize(glm::vec3(uniform(random) - .5F, uniform(random) - .5F, .5F * uniform(random)));
    };
    const glm::vec3 v = direction(), l = direction();
    const float there = Bsdf(s, v).evaluate(l, Lobes::all).x;
    EXPECT_NEAR(there, Bsdf(s, l).evaluate(v, Lobes::all).x, 1e-4F * there);
    EXPECT_GT(there, 0);
  }
}

// Both lobes together, sampled as paths do it: E + ρ(1−E), and all of it where nothing is absorbed.
TEST(Bsdf, CoatedSurfaceKeepsEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const float roughness : {0.F, .2F, .6F, 1.F}) {
    for (const float mu : {.2F, .6F, 1.F}) {
      const SurfacePoint point = glossy(roughness, glm::vec3(.04F), {1, .5F, 0});
      const Bsdf bsdf(point, at_cosine(mu));
      glm::dvec3 sum(0);
      constexpr int count = 40000;
      for (int i = 0; i < count; ++i) {
        const glm::vec2 u(uniform(random), uniform(random));
        sum += glm::dvec3(bsdf.sample(Lobes::all, u, {uniform(random), uniform(random)}).weight);
      }
      const glm::dvec3 all = sum / static_cast<double>(count);
      const double albedo = ggx_albedo(mu, point.alpha, point.f0).x;
      // The table's error is in both terms and cancels but for the sampled E; noise is 4σ.
      for (int c = 0; c < 3; ++c) {
        const double expected = albedo + static_cast<double>(point.albedo[c]) * (1 - albedo);
        EXPECT_NEAR(all[c], expected, .008) << roughness << ' ' << mu << ' ' << c;
      }
    }
  }
}

TEST(Bsdf, RefractsBySnellsLaw) {
  for (const bool inside : {false, true}) {
    SurfacePoint s = glossy(0, glm::vec3(.04F));
    s.transmission = 1;
    s.ior = 1.5F;
    s.inside = inside;
    s.base_color = glm::vec3(1);
    const float sine = .5F, eta = inside ? 1 / 1.5F : 1.5F;
    const glm::vec3 v = at_cosine(std::sqrt(1 - sine * sine));
    const BsdfSample refracted = Bsdf(s, v).sample(Lobes::all, {.3F, .6F}, {.5F, .9999F});
    EXPECT_NEAR(refracted.direction.x, -sine / eta, 1e-6F);
    EXPECT_NEAR(refracted.direction.y, 0, 1e-6F);
    EXPECT_LT(refracted.direction.z, 0);
    EXPECT_NEAR(refracted.weight.x, 1 / (eta * eta), 1e-5F) << "radiance changes by the square of the index";
    const BsdfSample reflected = Bsdf(s, v).sample(Lobes::all, {.3F, .6F}, {.5F, 1e-4F});
    EXPECT_NEAR(reflected.direction.x, -sine, 1e-6F);
    EXPECT_GT(reflected.direction.z, 0);
    EXPECT_NEAR(reflected.weight.x, 1, 1e-5F);
  }
  // Beyond the critical angle, 41.8°, nothing goes out.
  SurfacePoint s = glossy(0, glm::vec3(.04F));
  s.transmission = 1;
  s.inside = true;
  EXPECT_EQ(fresnel_dielectric(.7F, 1 / 1.5F), 1);
  EXPECT_GT(Bsdf(s, at_cosine(.7F)).sample(Lobes::all, {.3F, .6F}, {.5F, .9999F}).direction.z, 0);
}

scene::Material metal(glm::vec3 f0, float roughness) {
  scene::Material m;
  m.base_color = glm::vec4(f0, 1);
  m.metallic = 1;
  m.roughness = roughness;
  return m;
}

/// A large square in the plane y = 0, seen at this angle from the vertical.
struct Table {
  SceneBuilder builder;
  scene::Camera camera;
  Table(const scene::Material& material, double degrees, float half = 50) {
    builder.scene.surfaces = scene::SurfaceModel::ggx;
    builder.mesh(loom::test::quad({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}), material);
    const double angle = degrees * pi / 180;
    camera = probe({5 * std::sin(angle), 5 * std::cos(angle), 0}, {0, 0, 0}, .1);
  }
};

// A mirror shows what it reflects, times Schlick's factor: no noise, no blur.
TEST(SpecularPaths, MirrorShowsTheMirroredRadiance) {
  const double angle = 60;
  Table table(metal(glm::vec3(1, .5F, .25F), 0), angle);
  // In the mirrored direction a lamp; the sky beside it would show if the direction were off by a degree.
  const glm::vec3 n(static_cast<float>(-std::sin(angle * pi / 180)), .5F, 0);
  const glm::vec3 centre = 20.F * n, side(0, 0, .8F), up = .8F * glm::vec3(-n.y, n.x, 0);
  table.builder.sky(glm::vec3(7))
      .quad(centre - .5F * (side + up), side, up, {.emissive = glm::vec3(2, 3, 4), .double_sided = true});
  const Film film = render(table.builder.scene, table.camera, {4, 4}, 16);
  const double schlick = std::pow(.5, 5);
  for (int c = 0; c < 3; ++c) {
    const double f0 = std::pow(.5, c);
    const double expected = (f0 + (1 - f0) * schlick) * (2 + c);
    EXPECT_NEAR(over_pixels(film, Layer::radiance).mean[c], expected, 2e-6 * expected);
    EXPECT_NEAR(over_pixels(film, Layer::specular).mean[c], expected, 2e-6 * expected);
  }
}

// Under a sky of 1 a surface shows its directional albedo; the irradiance beside it is π, whatever the surface is.
TEST(SpecularPaths, UniformSkyShowsTheAlbedo) {
  const double angle = 60;
  scene::Material varnish;
  varnish.base_color = {1, .5F, .2F, 1};
  varnish.roughness = .4F;
  Table table(varnish, angle);
  table.builder.sky(glm::vec3(1));
  const Film film = render(table.builder.scene, table.camera, {16, 16}, 64);
  const double albedo = ggx_albedo(.5F, .16F, glm::vec3(.04F)).x;
  const glm::dvec3 rho(1, .5, .2);
  expect_mean(over_pixels(film, Layer::radiance), albedo + rho * (1 - albedo), .006);
  expect_mean(over_pixels(film, Layer::specular), glm::dvec3(albedo), .03);
  expect_mean(over_pixels(film, Layer::emitter), glm::dvec3(pi), 1e-4);
}

// Light samples alone, sampled directions alone and both agree: the densities are those of the samples.
TEST(SpecularPaths, StrategiesAgree) {
  Table table(metal(glm::vec3(.9F), .5F), 45);
  table.builder.quad({-3, 3, -1.5F}, {3, 0, 0}, {0, 0, 3}, {.emissive = glm::vec3(2), .double_sided = true});
  const auto estimate = [&](Strategy strategy) {
    return over_pixels(render(table.builder.scene, table.camera, {16, 16}, 64, {.bounces = 0, .strategy = strategy}),
                       Layer::specular);
  };
  const Estimate both = estimate(Strategy::mis);
  EXPECT_GT(both.mean.x, .1);
  for (const Strategy strategy : {Strategy::light, Strategy::bsdf}) {
    const Estimate one = estimate(strategy);
    const double error = std::sqrt(one.error.x * one.error.x + both.error.x * both.error.x);
    EXPECT_NEAR(one.mean.x, both.mean.x, confidence * error);
    EXPECT_LT(confidence * error, .05 * both.mean.x);
  }
}

// A slab of glass: with F at either face, light that goes to and fro sums to R = 2F/(1+F), T = (1−F)/(1+F).
TEST(SpecularPaths, GlassSlabReflectsAndTransmits) {
  scene::Material glass;
  glass.transmission = 1;
  glass.roughness = 0;
  const double angle = 65;
  Table table(glass, angle);
  const float half = 50, thick = .2F;
  table.builder.mesh(loom::test::quad({-half, -thick, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}), glass);
  const double f = fresnel_dielectric(static_cast<float>(std::cos(angle * pi / 180)), 1.5F);
  // The sky above through reflection; what is below through the slab.
  table.builder.sky(glm::vec3(1))
      .quad({-half, -1, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}, {.emissive = glm::vec3(0, 0, 3)});
  const Film film = render(table.builder.scene, table.camera, {16, 16}, 64);
  const double reflected = 2 * f / (1 + f), transmitted = (1 - f) / (1 + f);
  expect_mean_within(over_pixels(film, Layer::radiance), {reflected, reflected, reflected + 3 * transmitted}, .05);
  EXPECT_EQ(over_pixels(film, Layer::albedo).mean, glm::dvec3(0)) << "all that is not reflected goes through";
}

// Under a uniform sky nothing that absorbs nothing can be seen: radiance is the sky's.
TEST(SpecularPaths, FurnaceWithGlassAndMirrorIsUniform) {
  SceneBuilder b;
  b.scene.surfaces = scene::SurfaceModel::ggx;
  b.sky(glm::vec3(1));
  scene::Material glass;
  glass.transmission = 1;
  glass.roughness = 0;
  // A block of glass over a mirror: whatever is hit, and however often, nothing gets lost.
  loom::test::add_box(b.scene, {-1, .3F, -1}, {1, .6F, 1}, loom::test::add_material(b.scene, glass));
  b.mesh(loom::test::quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), metal(glm::vec3(1), 0));
  const Film film = render(b.scene, probe({3, 4, 2}, {0, .3, 0}, .5), {16, 16}, 64);
  expect_mean(over_pixels(film, Layer::radiance), glm::dvec3(1), 2e-3);
}

}  // namespace
}  // namespace loom::reference::test
