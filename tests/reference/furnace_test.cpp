// Enclosures whose light has a closed form.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "reference/scenes.h"

namespace loom::reference::test {
namespace {

constexpr double pi = std::numbers::pi;
using Look = SceneBuilder::Look;

scene::Camera inside(double half = .9) { return probe({0, 0, 0}, {0, 0, -1}, half); }

// Closed furnace: every surface emits L_e and reflects ρ, so radiance is L_e/(1−ρ) everywhere.
TEST(Furnace, IsEmissionOverOneMinusAlbedo) {
  const glm::vec3 albedo(.8F, .5F, .2F);
  const auto scene = SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {albedo, glm::vec3(1, 2, 3)}).scene;
  const Film film = render(scene, inside(), {16, 16}, 64);
  expect_mean_within(over_pixels(film, Layer::radiance), glm::dvec3(1, 2, 3) / (1. - glm::dvec3(albedo)), .01);
}

// With reflections limited to N before the light arrives: L_e(1−ρᴺ⁺²)/(1−ρ).
TEST(Furnace, WithLimitedBouncesIsThePartialSum) {
  const double albedo = .7;
  const auto scene = SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {grey(albedo), glm::vec3(1)}).scene;
  for (const int bounces : {0, 1, 3, 8}) {
    SCOPED_TRACE(bounces);
    const Film film = render(scene, inside(), {16, 16}, 16, {.bounces = bounces});
    expect_mean_within(over_pixels(film, Layer::radiance),
                       glm::dvec3((1 - std::pow(albedo, bounces + 2)) / (1 - albedo)), .02);
  }
}

// The irradiance of a furnace splits into π·L_e straight from the walls and the rest.
TEST(Furnace, SplitsEmitterFromBounce) {
  const auto scene = SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {glm::vec3(.5F), glm::vec3(1)}).scene;
  const Film film = render(scene, inside(), {16, 16}, 64);
  expect_mean_within(over_pixels(film, Layer::emitter), glm::dvec3(pi), .01);
  expect_mean_within(over_pixels(film, Layer::bounce), glm::dvec3(pi), .02);
  EXPECT_EQ(over_pixels(film, Layer::direct).mean, glm::dvec3(0));
}

/// Distance of the nearest triangle's plane from the origin.
double inscribed_radius(const scene::Primitive& primitive) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
    const glm::dvec3 a = primitive.positions[primitive.indices[i]];
    const glm::dvec3 b = primitive.positions[primitive.indices[i + 1]];
    const glm::dvec3 c = primitive.positions[primitive.indices[i + 2]];
    nearest = std::min(nearest, std::abs(glm::dot(glm::normalize(glm::cross(b - a, c - a)), a)));
  }
  return nearest;
}

// The sphere of Φ = 4πI at its centre: E = ρᵏΦ/(4πR²) after k reflections. Our sphere is a polyhedron between radii
// r and R, so its E is more, but by no more than (R/r)² − 1.
TEST(IntegratingSphere, BounceByBounce) {
  const double radius = 2, intensity = 3, albedo = .6;
  const auto scene = SceneBuilder()
                         .hollow_sphere(static_cast<float>(radius), 4, {.albedo = grey(albedo)})
                         .point({0, 0, 0}, grey(intensity))
                         .scene;
  const double straight = intensity / (radius * radius);  // Φ/(4πR²)
  const double inscribed = inscribed_radius(scene.meshes[0].primitives[0]);
  const double polyhedron = radius * radius / (inscribed * inscribed) - 1;
  ASSERT_LT(polyhedron, .0025);
  const Film film = render(scene, inside(1), {12, 12}, 64);
  Estimate direct = over_pixels(film, Layer::direct);
  expect_mean(direct, glm::dvec3(straight), polyhedron);
  double sum = 0;
  for (int k = 1; k <= 3; ++k) {
    SCOPED_TRACE(k);
    sum += std::pow(albedo, k) * straight;
    const Film limited = render(scene, inside(1), {12, 12}, 32, {.bounces = k});
    expect_mean(over_pixels(limited, Layer::bounce), glm::dvec3(sum), polyhedron);
  }
  expect_mean(over_pixels(film, Layer::bounce), glm::dvec3(straight * albedo / (1 - albedo)), polyhedron);
}

// Infinite parallel plates (here 400 apart-distances wide): L1 = L_e/(1−ρ1ρ2), L2 = ρ2·L1, E2 = π·L1.
// A ray leaves between the edges with a chance of about 2(d/w)² a crossing: 1e-4 of the light is lost, 3e-4 with ρ's.
TEST(ParallelPlates, InfiniteSum) {
  const float half = 200;
  const double rho1 = .5, rho2 = .8, emitted = 2;
  SceneBuilder b;
  b.quad({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}, {grey(rho1), grey(emitted)});  // faces up
  b.quad({-half, 1, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}, {.albedo = grey(rho2)});       // faces down
  const double l1 = emitted / (1 - rho1 * rho2);
  const Film lower = render(b.scene, probe({0, .5, 0}, {0, 0, 0}, 1), {16, 16}, 64);
  const Film upper = render(b.scene, probe({0, .5, 0}, {0, 1, 0}, 1), {16, 16}, 64);
  expect_mean(over_pixels(lower, Layer::radiance), glm::dvec3(l1), 5e-4);
  expect_mean(over_pixels(upper, Layer::radiance), glm::dvec3(rho2 * l1), 5e-4);
  const Estimate straight = over_pixels(upper, Layer::emitter);
  const Estimate bounced = over_pixels(upper, Layer::bounce);
  expect_mean({straight.mean + bounced.mean, straight.error + bounced.error}, glm::dvec3(pi * l1), 5e-4);
}

// Closed box lit by a point light of flux Φ: what the walls absorb is what the light gives, Σ A·E·(1−ρ) = Φ.
// An orthographic view of each whole wall, from a point just off it, averages E over its area.
TEST(ClosedBox, AbsorbsWhatIsEmitted) {
  const glm::vec3 albedo(.3F, .6F, .85F);
  const double intensity = 5;
  const auto scene =
      SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {.albedo = albedo}).point({.3, -.2, .4}, grey(intensity)).scene;
  glm::dvec3 absorbed(0), variance(0);
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    const Film film = render(scene, probe(.99 * axis, axis, 1), {16, 16}, 64);
    const double area = 4;
    const glm::dvec3 kept = area * (1. - glm::dvec3(albedo));
    for (const Layer q : {Layer::direct, Layer::bounce}) absorbed += kept * over_pixels(film, q).mean;
    // The spread over pixels is that of E itself; the film's standard errors tell the noise. Of L = ρ/π·E:
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) {
        const glm::dvec3 e = kept * Film::standard_error(film.pixel(x, y)) * pi / glm::dvec3(albedo) / 256.;
        variance += e * e;
      }
    }
  }
  expect_mean_within({absorbed, glm::sqrt(variance)}, glm::dvec3(4 * pi * intensity), .01);
}

// A white box: light is never absorbed, paths end by roulette alone, and what they bring stays finite.
TEST(ClosedBox, WhiteWallsWithLimitedBouncesCountEveryBounceFully) {
  const auto scene = SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {glm::vec3(1), glm::vec3(1)}).scene;
  const Film film = render(scene, inside(), {8, 8}, 16, {.bounces = 100});
  expect_mean(over_pixels(film, Layer::radiance), glm::dvec3(102));
}

}  // namespace
}  // namespace loom::reference::test
