#include "reference/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "support/hand_scene.h"

namespace loom::reference::test {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

scene::Material material_of(const SceneBuilder::Look& look) {
  scene::Material material;
  material.base_color = glm::vec4(look.albedo, 1);
  material.emissive = look.emissive;
  material.double_sided = look.double_sided;
  return material;
}

void append(scene::Primitive& to, const scene::Primitive& from) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  to.normals.insert(to.normals.end(), from.normals.begin(), from.normals.end());
  for (const std::uint32_t i : from.indices) to.indices.push_back(first + i);
}

/// Each triangle into four, new corners on the unit sphere.
std::vector<glm::vec3> subdivide(const std::vector<glm::vec3>& corners) {
  std::vector<glm::vec3> finer;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec3 a = corners[i], b = corners[i + 1], c = corners[i + 2];
    const glm::vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
    finer.insert(finer.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
  return finer;
}

std::vector<glm::vec3> icosahedron() {
  const float phi = std::numbers::phi_v<float>;
  const std::array<glm::vec3, 12> p = {{{-1, phi, 0},
                                        {1, phi, 0},
                                        {-1, -phi, 0},
                                        {1, -phi, 0},
                                        {0, -1, phi},
                                        {0, 1, phi},
                                        {0, -1, -phi},
                                        {0, 1, -phi},
                                        {phi, 0, -1},
                                        {phi, 0, 1},
                                        {-phi, 0, -1},
                                        {-phi, 0, 1}}};
  std::vector<glm::vec3> corners;
  // Every triple of mutually nearest corners (edge 2) is a face.
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        const auto near = [&](std::size_t a, std::size_t b) { return glm::distance(p[a], p[b]) < 2.1F; };
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const bool inwards = glm::dot(glm::cross(p[j] - p[i], p[k] - p[i]), p[i]) < 0;
        corners.push_back(glm::normalize(p[i]));
        corners.push_back(glm::normalize(inwards ? p[j] : p[k]));
        corners.push_back(glm::normalize(inwards ? p[k] : p[j]));
      }
    }
  }
  return corners;
}

}  // namespace

SceneBuilder& SceneBuilder::mesh(scene::Primitive primitive, const scene::Material& material, const glm::dmat4& world) {
  primitive.material = loom::test::add_material(scene, material);
  loom::test::place(scene, std::move(primitive), world);
  return *this;
}

SceneBuilder& SceneBuilder::quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v, const Look& look) {
  return mesh(loom::test::quad(corner, u, v), material_of(look));
}

SceneBuilder& SceneBuilder::room(glm::vec3 lower, glm::vec3 upper, const Look& look) {
  const glm::vec3 d = upper - lower;
  const glm::vec3 x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  scene::Primitive primitive = loom::test::quad(lower, y, z);
  primitive.uv0.clear();
  append(primitive, loom::test::quad(lower, z, x));
  append(primitive, loom::test::quad(lower, x, y));
  append(primitive, loom::test::quad(upper, -z, -y));
  append(primitive, loom::test::quad(upper, -x, -z));
  append(primitive, loom::test::quad(upper, -y, -x));
  return mesh(primitive, material_of(look));
}

SceneBuilder& SceneBuilder::hollow_sphere(float radius, int subdivisions, const Look& look) {
  std::vector<glm::vec3> corners = icosahedron();
  for (int i = 0; i < subdivisions; ++i) corners = subdivide(corners);
  scene::Primitive primitive;
  for (const glm::vec3& c : corners) {
    primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
    primitive.positions.push_back(c * radius);
    primitive.normals.push_back(-c);
  }
  return mesh(primitive, material_of(look));
}

SceneBuilder& SceneBuilder::point(glm::dvec3 position, glm::vec3 intensity) {
  scene.lights.push_back({.kind = scene::LightKind::point, .position = position, .intensity = intensity});
  return *this;
}

SceneBuilder& SceneBuilder::spot(glm::dvec3 position, glm::dvec3 direction, glm::vec3 intensity, double inner_deg,
                                 double outer_deg) {
  scene.lights.push_back({.kind = scene::LightKind::spot,
                          .position = position,
                          .direction = glm::normalize(direction),
                          .intensity = intensity,
                          .inner_rad = radians(inner_deg),
                          .outer_rad = radians(outer_deg)});
  return *this;
}

SceneBuilder& SceneBuilder::directional(glm::dvec3 direction, glm::vec3 irradiance) {
  scene.lights.push_back(
      {.kind = scene::LightKind::directional, .direction = glm::normalize(direction), .intensity = irradiance});
  return *this;
}

SceneBuilder& SceneBuilder::sky(glm::vec3 radiance) {
  scene.sky = radiance;
  return *this;
}

scene::Scene cornell_box(bool with_quad) {
  using Look = SceneBuilder::Look;
  const Look white{.albedo = {.738F, .736F, .740F}};
  const Look red{.albedo = {.490F, .0504F, .0511F}};
  const Look green{.albedo = {.0686F, .398F, .0866F}};
  const Look lamp{.albedo = glm::vec3(.78F), .emissive = {20.62F, 10.91F, 2.762F}};
  SceneBuilder b;
  b.quad({0, 0, 0}, {0, 0, 5.592F}, {5.528F, 0, 0}, white);
  b.quad({0, 5.488F, 0}, {5.56F, 0, 0}, {0, 0, 5.592F}, white);
  b.quad({0, 0, 5.592F}, {0, 5.488F, 0}, {5.496F, 0, 0}, white);
  b.quad({0, 0, 0}, {0, 5.488F, 0}, {0, 0, 5.592F}, green);
  b.quad({5.528F, 0, 0}, {0, 0, 5.592F}, {0, 5.488F, 0}, red);
  if (with_quad) {
    b.quad({2.13F, 5.4875F, 2.27F}, {1.3F, 0, 0}, {0, 0, 1.05F}, lamp);
  } else {
    b.spot({2.78, 5.3, 2.8}, {0, -1, 0}, {60, 60, 60}, 25, 45);
  }
  // A block standing on the quad a b c d (counter-clockwise from above).
  const auto block = [&](glm::vec2 p0, glm::vec2 p1, glm::vec2 p3, float height) {
    const glm::vec3 o(p0.x, 0, p0.y);
    const glm::vec3 u(p1.x - p0.x, 0, p1.y - p0.y);
    const glm::vec3 v(p3.x - p0.x, 0, p3.y - p0.y);
    const glm::vec3 h(0, height, 0);
    b.quad(o + h, u, v, white);
    b.quad(o, u, h, white);
    b.quad(o + u, v, h, white);
    b.quad(o + u + v, -u, h, white);
    b.quad(o + v, -v, h, white);
  };
  block({1.3F, .65F}, {.82F, 2.25F}, {2.9F, 1.14F}, 1.65F);
  block({4.23F, 2.47F}, {2.65F, 2.96F}, {4.72F, 4.06F}, 3.3F);
  return b.scene;
}

scene::Camera cornell_camera() {
  scene::Camera camera;
  camera.eye = {2.78, 2.73, -8};
  camera.target = {2.78, 2.73, 0};
  camera.yfov_rad = 2 * std::atan(.0125 / .035);
  return camera;
}

scene::Camera probe(glm::dvec3 eye, glm::dvec3 target, double half) {
  scene::Camera camera;
  camera.eye = eye;
  camera.target = target;
  const glm::dvec3 d = glm::normalize(target - eye);
  camera.up = std::abs(d.y) > .9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
  camera.orthographic = true;
  camera.xmag = camera.ymag = half;
  return camera;
}

Film render(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size, std::uint32_t samples,
            const Options& options) {
  const PathTracer tracer(scene, camera.eye, options);
  Film film(size, identify(scene, camera, size, options), options.seed);
  tracer.accumulate(film, view_of(camera, scene, size, camera.eye), samples);
  EXPECT_EQ(film.non_finite(), 0U);
  return film;
}

Estimate over_pixels(const Film& film, Layer layer) {
  glm::dvec3 sum(0), squares(0);
  const double n = static_cast<double>(film.size().x) * film.size().y;
  for (int y = 0; y < film.size().y; ++y) {
    for (int x = 0; x < film.size().x; ++x) {
      const PixelSums& p = film.pixel(x, y);
      const glm::dvec3 value = Film::mean(p, layer);
      sum += value;
      squares += value * value;
    }
  }
  const glm::dvec3 mean = sum / n;
  return {mean, glm::sqrt(glm::max(squares / n - mean * mean, glm::dvec3(0)) / (n - 1))};
}

void expect_mean(const Estimate& estimate, glm::dvec3 expected, double rounding) {
  for (glm::length_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(estimate.mean[c], expected[c], confidence * estimate.error[c] + rounding * std::abs(expected[c]))
        << "channel " << c << ", standard error " << estimate.error[c];
  }
}

void expect_mean_within(const Estimate& estimate, glm::dvec3 expected, double width) {
  expect_mean(estimate, expected);
  for (glm::length_t c = 0; c < 3; ++c) {
    EXPECT_LE(confidence * estimate.error[c], width * std::abs(expected[c]))
        << "the interval is too wide, channel " << c;
  }
}

}  // namespace loom::reference::test
