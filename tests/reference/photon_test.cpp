// Photon mapping against closed forms, and against the path tracer, with which it shares no estimator.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/photons.h"
#include "reference/scenes.h"

namespace loom::reference::test {
namespace {

constexpr double pi = std::numbers::pi;

Film map_photons(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size, std::uint32_t passes,
                 const PhotonOptions& options = {}) {
  const PhotonMapper mapper(scene, camera.eye, options);
  Film film(size, identify(scene, camera, size, options), options.seed);
  for (std::uint32_t i = 0; i < passes; ++i) mapper.accumulate(film, view_of(camera, scene, size, camera.eye));
  EXPECT_EQ(film.non_finite(), 0U);
  return film;
}

glm::dvec3 mean(const Film& film, Layer layer) { return over_pixels(film, layer).mean; }

void expect_near(const glm::dvec3& value, const glm::dvec3& expected, double share) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], share * expected[c]);
}

// Of 4 passes of 50,000 photons on 24 m², a disc of 3.5 cm holds 30 for each pixel, the picture of .8 of a wall 10,000:
// the mean is within 2 % at two standard errors.
TEST(Photons, FurnaceWithLimitedBounces) {
  const glm::vec3 albedo(.8F, .5F, .2F), emission(1, 2, 3);
  const auto scene = SceneBuilder().room(glm::vec3(-1), glm::vec3(1), {albedo, emission}).scene;
  const scene::Camera camera = probe({0, 0, 0}, {0, 0, -1}, .8);
  for (const int bounces : {0, 3}) {
    const Film film = map_photons(scene, camera, {16, 16}, 4, {.bounces = bounces, .photons = 50000, .radius = .01});
    glm::dvec3 bounce(0);
    for (int k = 1; k <= bounces; ++k)
      bounce += pi * glm::dvec3(emission) * glm::pow(glm::dvec3(albedo), glm::dvec3(k));
    expect_near(mean(film, Layer::emitter), pi * glm::dvec3(emission), .02);
    if (bounces > 0) expect_near(mean(film, Layer::bounce), bounce, .03);
  }
}

// E = I·cosθ/r² straight under a point light, E⊥·cosθ of a directional one, all of it direct.
TEST(Photons, StraightLight) {
  const SceneBuilder::Look black;
  const scene::Camera camera = probe({0, 1, 0}, {0, 0, 0}, .05);
  const auto floor = [&] { return SceneBuilder().quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, black); };
  const auto by_point = floor().point({0, 2, 0}, glm::vec3(8)).scene;
  expect_near(mean(map_photons(by_point, camera, {4, 4}, 8, {.radius = .02}), Layer::direct), glm::dvec3(2), .03);
  const auto by_sun = floor().directional({1, -1, 0}, glm::vec3(3)).scene;
  const Film sun = map_photons(by_sun, camera, {4, 4}, 8, {.radius = .02});
  expect_near(mean(sun, Layer::direct), glm::dvec3(3 * std::sqrt(.5)), .02);
  EXPECT_EQ(mean(sun, Layer::emitter), glm::dvec3(0));
  const auto by_spot = floor().spot({0, 2, 0}, {0, -1, 0}, glm::vec3(8), 20, 30).scene;
  expect_near(mean(map_photons(by_spot, camera, {4, 4}, 8, {.photons = 50000, .radius = .01}), Layer::direct),
              glm::dvec3(2), .03);
  const auto by_sky = floor().sky(glm::vec3(2)).scene;
  expect_near(mean(map_photons(by_sky, camera, {4, 4}, 8, {.radius = .02}), Layer::emitter), glm::dvec3(2 * pi), .03);
}

// r²_{i+1} = r²_i·(i+⅔)/(i+1); i is counted from 1.
TEST(Photons, TheRadiusShrinks) {
  const scene::Scene scene = cornell_box();
  const PhotonMapper mapper(scene, cornell_camera().eye, {});
  EXPECT_NEAR(mapper.radius(1) / mapper.radius(0), std::sqrt(5. / 6), 1e-12);
  EXPECT_NEAR(mapper.radius(2) / mapper.radius(1), std::sqrt(8. / 9), 1e-12);
  EXPECT_LT(mapper.radius(1000), .35 * mapper.radius(0));
}

// Photons are kept by task: the same bits on one thread.
TEST(Photons, ThreadsDoNotMatter) {
  const scene::Scene scene = cornell_box();
  const PhotonOptions options{.photons = 20000};
  PhotonOptions one = options;
  one.threads = 1;
  const Film a = map_photons(scene, cornell_camera(), {16, 16}, 2, options);
  const Film b = map_photons(scene, cornell_camera(), {16, 16}, 2, one);
  EXPECT_EQ(a.layers().channels, b.layers().channels);
}

// What the two references say of the Cornell boxes. The photon maps' passes are independent, so that their spread is
// the error of the mean; beside it stands what discs lose that reach over an edge, 2r/3π of a wall along each edge of
// it: less than 1 % of walls of 5.5 m.
TEST(Photons, AgreeWithThePathTracerOnBothBoxes) {
  for (const bool lamp : {true, false}) {
    SCOPED_TRACE(lamp ? "lamp" : "spot");
    const scene::Scene scene = cornell_box(lamp);
    const glm::ivec2 size(64, 64);
    const Film truth = render(scene, cornell_camera(), size, 64);
    const Film photons = map_photons(scene, cornell_camera(), size, replicates, {.photons = 60000, .radius = .006});
    const double n = static_cast<double>(size.x) * size.y;
    double sum = 0, squares = 0, expected = 0;
    int within = 0;
    for (int r = 0; r < replicates; ++r) {
      double of_pass = 0;
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) of_pass += photons.pixel(x, y).radiance.at(static_cast<std::size_t>(r)).x / n;
      }
      sum += of_pass;
      squares += of_pass * of_pass;
    }
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const double a = Film::mean(photons.pixel(x, y)).x, b = Film::mean(truth.pixel(x, y)).x;
        const double error =
            std::hypot(Film::standard_error(photons.pixel(x, y)).x, Film::standard_error(truth.pixel(x, y)).x);
        expected += b / n;
        if (std::abs(a - b) <= 3 * error + .02 * b) ++within;
      }
    }
    const double value = sum / replicates;
    const double error = std::sqrt((squares / replicates - value * value) / (replicates - 1));
    // A lamp that the camera sees is a twelfth of it all, and differs by its edge from pass to pass.
    EXPECT_LT(confidence * error, .05 * expected);
    EXPECT_NEAR(value, expected, confidence * error + .01 * expected);
    // The others are the pixels at edges, and one in a hundred by chance.
    EXPECT_GT(within, .9 * n);
  }
}

}  // namespace
}  // namespace loom::reference::test
