// What must hold on any scene: linearity, rotation, units, distance from the origin.
#include <cmath>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "reference/scenes.h"

namespace loom::reference::test {
namespace {

constexpr glm::ivec2 size{24, 24};

/// Everything moved by `transform` (a rotation, a uniform scale, a translation); intensities of lights as they are.
void move(scene::Scene& scene, scene::Camera& camera, const glm::dmat4& transform) {
  const auto point = [&](const glm::dvec3& p) { return glm::dvec3(transform * glm::dvec4(p, 1)); };
  const auto vector = [&](const glm::dvec3& v) { return glm::normalize(glm::dmat3(transform) * v); };
  for (auto& instance : scene.instances) instance.world = transform * instance.world;
  for (auto& light : scene.lights) {
    light.position = point(light.position);
    light.direction = vector(light.direction);
  }
  camera.eye = point(camera.eye);
  camera.target = point(camera.target);
  camera.up = vector(camera.up);
}

/// ‖a−b‖/‖b‖ of the radiance.
double relative_l2(const Film& a, const Film& b) {
  double difference = 0, norm = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec3 p = Film::mean(a.pixel(x, y)), q = Film::mean(b.pixel(x, y));
      difference += glm::dot(p - q, p - q);
      norm += glm::dot(q, q);
    }
  }
  return std::sqrt(difference / norm);
}

/// Sum over the image with its standard error.
Estimate total(const Film& film) {
  Estimate e;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      e.mean += Film::mean(film.pixel(x, y));
      const glm::dvec3 s = Film::standard_error(film.pixel(x, y));
      e.error += s * s;
    }
  }
  e.error = glm::sqrt(e.error);
  return e;
}

/// Everything that emits at once.
scene::Scene everything() {
  scene::Scene scene = cornell_box();
  const scene::Scene spot = cornell_box(false);
  scene.lights = spot.lights;
  scene.lights.push_back({.kind = scene::LightKind::directional,
                          .direction = glm::normalize(glm::dvec3(.2, -.5, 1)),
                          .intensity = glm::vec3(2)});
  scene.sky = {.2F, .3F, .5F};
  return scene;
}

TEST(Metamorphic, TwiceTheEmissionIsTwiceTheImageExactly) {
  scene::Scene twice = everything();
  twice.sky *= 2;
  for (auto& light : twice.lights) light.intensity *= 2;
  for (auto& material : twice.materials) material.emissive *= 2;
  const Film one = render(everything(), cornell_camera(), size, 16), two = render(twice, cornell_camera(), size, 16);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      ASSERT_EQ(Film::mean(two.pixel(x, y)), 2. * Film::mean(one.pixel(x, y))) << x << ", " << y;
    }
  }
}

// Light is additive: lamp, punctual lights and sky together are their sum.
TEST(Metamorphic, LightsSuperpose) {
  scene::Scene lamp = everything(), punctual = everything(), sky = everything();
  lamp.lights.clear();
  lamp.sky = glm::vec3(0);
  for (auto* dark : {&punctual, &sky}) {
    for (auto& material : dark->materials) material.emissive = glm::vec3(0);
  }
  punctual.sky = glm::vec3(0);
  sky.lights.clear();
  Estimate sum;
  std::uint64_t seed = 1;
  for (const auto* part : {&lamp, &punctual, &sky}) {
    const Estimate e = total(render(*part, cornell_camera(), size, 64, {.seed = seed++}));
    sum.mean += e.mean;
    sum.error += e.error * e.error;
  }
  const Estimate all = total(render(everything(), cornell_camera(), size, 64));
  expect_mean_within({all.mean, glm::sqrt(all.error * all.error + sum.error)}, sum.mean, .05);
}

TEST(Metamorphic, RotationTurnsNothingElse) {
  scene::Scene scene = everything();
  scene::Camera camera = cornell_camera();
  const Estimate before = total(render(scene, camera, size, 64));
  move(scene, camera, glm::rotate(glm::dmat4(1), std::numbers::pi / 2, glm::dvec3(1, 0, 0)));
  const Estimate after = total(render(scene, camera, size, 64, {.seed = 1}));
  expect_mean_within({after.mean, glm::sqrt(after.error * after.error + before.error * before.error)}, before.mean,
                     .05);
}

// Positions × k, point and spot × k², emission, sky and directional unchanged: the same image.
TEST(Metamorphic, UnitsDoNotMatter) {
  const Film metres = render(everything(), cornell_camera(), size, 16);
  for (const double k : {1e-3, 1e3, 1. / 1024, 1e6}) {
    scene::Scene scene = everything();
    scene::Camera camera = cornell_camera();
    move(scene, camera, glm::scale(glm::dmat4(1), glm::dvec3(k)));
    for (auto& light : scene.lights) {
      if (light.kind != scene::LightKind::directional) light.intensity *= static_cast<float>(k * k);
    }
    EXPECT_LT(relative_l2(render(scene, camera, size, 16), metres), 1e-4) << k;
  }
}

// A thousand kilometres from the origin, where a float's ulp is 6 cm, all is as it was: positions are recentred on the
// camera in double. (The instance's matrix is double; vertices are the mesh's own.)
TEST(Metamorphic, FarFromTheOriginIsTheSame) {
  scene::Scene scene = everything();
  scene::Camera camera = cornell_camera();
  const Film here = render(scene, camera, size, 16);
  move(scene, camera, glm::translate(glm::dmat4(1), glm::dvec3(1e6, -1e6, 1e6)));
  EXPECT_LT(relative_l2(render(scene, camera, size, 16), here), 1e-4);
}

}  // namespace
}  // namespace loom::reference::test
