// Skies that are images: how the path tracer finds them, and what they light.
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "loom/harmonics.h"
#include "reference/photons.h"
#include "reference/scenes.h"
#include "reference/sky_sampler.h"
#include "scene/sky.h"
#include "support/sky_images.h"

namespace loom::reference::test {
namespace {

using loom::test::irradiance_of_two_bands;
using loom::test::sky_of_two_bands;

constexpr double pi = std::numbers::pi;

scene::Scene under(scene::SkyImage image, const glm::vec3& u = {0, 0, 10}, const glm::vec3& v = {10, 0, 0}) {
  SceneBuilder b;
  b.quad(-.5F * (u + v), u, v, {.albedo = glm::vec3(.5F)});
  scene::set_sky(b.scene, std::move(image));
  return b.scene;
}

/// Dark but for one texel that is as bright as a sun.
scene::SkyImage spike() {
  scene::SkyImage image{.width = 32, .height = 16};
  image.radiance.assign(32 * 16, glm::vec3(.1F));
  image.radiance[3 * 32 + 20] = glm::vec3(1000, 500, 200);
  image.rotation_rad = .7;
  return image;
}

// ∫ p dω = 1, over a grid that is finer than the texels; and samples land where p says.
TEST(SkyImage, DensityIntegratesToOne) {
  const scene::Scene scene = under(spike());
  const SkySampler sampler(scene);
  double integral = 0;
  constexpr int rows = 256;
  for (int y = 0; y < rows; ++y) {
    const double belt = std::cos(pi * y / rows) - std::cos(pi * (y + 1) / rows);
    for (int x = 0; x < 2 * rows; ++x) {
      const auto w = scene::SkyImage::direction_of({(x + .5) / (2 * rows), (y + .5) / rows});
      integral += sampler.density(glm::vec3(w)) * belt * 2 * pi / (2 * rows);
    }
  }
  EXPECT_NEAR(integral, 1, 1e-3);
  // ⟨1/p⟩ = 4π over samples, for which no direction may be left out and none be told a wrong density.
  double sphere = 0;
  constexpr int side = 512;
  for (int i = 0; i < side * side; ++i) {
    const glm::vec2 u((static_cast<float>(i % side) + .5F) / side, (static_cast<float>(i / side) + .5F) / side);
    const glm::vec3 w = sampler.sample(u);
    EXPECT_NEAR(glm::length(w), 1, 1e-5);
    sphere += 1 / sampler.density(w) / (side * side);
  }
  // In the row of the spike all else has a hundredth of u.x, five strata: a stratum more or less is a fifth of that
  // row, which is a sixteenth of the sphere.
  EXPECT_NEAR(sphere, 4 * pi, .05 * 4 * pi);
}

// E = πa + 2π/3·b⟨axis,n⟩ by each strategy alone and together. Interpolation takes δ²/12 of the band along each axis, δ
// being π/64: 4e-4.
TEST(SkyImage, OfTwoBandsOverAPlane) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 1, -.5)), b(.9, .5, -.6);
  const scene::Scene scene = under(sky_of_two_bands(1, b, axis));
  const glm::dvec3 expected = irradiance_of_two_bands(1, b, axis, {0, 1, 0});
  for (const Strategy strategy : {Strategy::mis, Strategy::light, Strategy::bsdf}) {
    const Film film = render(scene, probe({0, .5, 0}, {0, 0, 0}, 1e-3), {16, 16}, 16, {.strategy = strategy});
    expect_mean(over_pixels(film, Layer::emitter), expected, 1e-3);
  }
}

// An image that is the same everywhere is a constant sky, πL; the photons agree.
TEST(SkyImage, OfOneColourIsTheConstantSky) {
  const scene::Scene scene = under(sky_of_two_bands(2, glm::dvec3(0), {0, 1, 0}, 8));
  const scene::Camera camera = probe({0, .5, 0}, {0, 0, 0}, 1e-3);
  expect_mean(over_pixels(render(scene, camera, {16, 16}, 16), Layer::emitter), glm::dvec3(2 * pi));
}

// All strategies find the same light of a small sun, and sampling the image finds it with far less noise.
TEST(SkyImage, ASmallSunIsFound) {
  const scene::Scene scene = under(spike());
  const scene::Camera camera = probe({0, .5, 0}, {0, 0, 0}, 1e-3);
  const auto of = [&](Strategy strategy, std::uint32_t samples) {
    return over_pixels(render(scene, camera, {16, 16}, samples, {.strategy = strategy}), Layer::emitter);
  };
  const Estimate light = of(Strategy::light, 16), bsdf = of(Strategy::bsdf, 16), mis = of(Strategy::mis, 16);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(light.mean[c], bsdf.mean[c], confidence * (light.error[c] + bsdf.error[c]));
    EXPECT_NEAR(light.mean[c], mis.mean[c], confidence * (light.error[c] + mis.error[c]));
  }
  EXPECT_LT(4 * light.error.x, bsdf.error.x);
}

// Turning the sky by a quarter about +Y is turning everything else back: a tilted plane tells which way.
TEST(SkyImage, TurningItIsTurningTheScene) {
  const glm::dvec3 axis(0, 0, 1), b(.9);
  scene::SkyImage turned = sky_of_two_bands(1, b, axis);
  turned.rotation_rad = pi / 2;
  // +Z goes to +X. A plane that faces +X:
  const scene::Scene wall = under(turned, {0, 10, 0}, {0, 0, 10});
  const Film film = render(
      wall,
      [] {
        scene::Camera camera = probe({.5, 0, 0}, {0, 0, 0}, 1e-3);
        camera.up = {0, 1, 0};
        return camera;
      }(),
      {16, 16}, 16);
  expect_mean(over_pixels(film, Layer::emitter), irradiance_of_two_bands(1, b, {1, 0, 0}, {1, 0, 0}), 1e-3);
}

// What the camera sees where it sees no surface.
TEST(SkyImage, IsTheBackground) {
  const glm::dvec3 axis(0, 0, -1);
  scene::Scene scene = under(sky_of_two_bands(1, glm::dvec3(.5), axis));
  scene::Camera camera = probe({0, 20, 0}, {0, 20, -1}, .1);
  camera.up = {0, 1, 0};
  EXPECT_NEAR(over_pixels(render(scene, camera, {4, 4}, 1), Layer::radiance).mean.x, 1.5, 1e-3);
}

}  // namespace
}  // namespace loom::reference::test
