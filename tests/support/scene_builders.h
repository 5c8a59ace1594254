#pragma once
// Whole surfaces, lights and cameras for scenes with known answers, on top of hand_scene.h. Metres.
#include <cmath>
#include <cstdint>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/content_hash.h"
#include "scene/scene.h"
#include "support/hand_scene.h"

namespace loom::test {

/// A diffuse surface: albedo and exitant radiance, W/(m² sr).
inline scene::Material diffuse(glm::vec3 albedo, glm::vec3 radiance = glm::vec3(0)) {
  scene::Material material;
  material.base_color = glm::vec4(albedo, 1);
  material.metallic = 0;
  material.emissive = radiance;
  return material;
}

/// A square of side 2·half in the plane y = `height`, centred on the y axis; front up, or down where `down`.
inline void add_plane(scene::Scene& scene, float half, float height, int material, bool down = false) {
  const glm::vec3 corner(-half, height, -half);
  const glm::vec3 x(2 * half, 0, 0);
  const glm::vec3 z(0, 0, 2 * half);
  place(scene, down ? quad(corner, x, z, material) : quad(corner, z, x, material));
}

/// An axis-aligned box, six quads; fronts face out, or in where `inward` (a furnace).
inline void add_box(scene::Scene& scene, glm::vec3 low, glm::vec3 high, int material, bool inward = false) {
  const glm::vec3 extent = high - low;
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 u(0);
    glm::vec3 v(0);
    u[(axis + 1) % 3] = extent[(axis + 1) % 3];
    v[(axis + 2) % 3] = extent[(axis + 2) % 3];
    glm::vec3 far_corner = low;
    far_corner[axis] = high[axis];
    // u × v points along +axis: out through the far side, in through the near one.
    place(scene, inward ? quad(far_corner, v, u, material) : quad(far_corner, u, v, material));
    place(scene, inward ? quad(low, u, v, material) : quad(low, v, u, material));
  }
}

/// A flat-shaded sphere of `rings` × 2·`rings` facets whose corners lie on it; fronts face out, or in where `inward`.
inline void add_sphere(scene::Scene& scene, glm::vec3 centre, float radius, int rings, int material,
                       bool inward = false) {
  constexpr double pi = 3.14159265358979323846;
  const auto at = [&](int ring, int step) {
    const double theta = pi * ring / rings;
    const double phi = pi * step / rings;
    return centre +
           radius * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  scene::Primitive sphere;
  sphere.material = material;
  const auto add = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    if (inward) std::swap(b, c);
    const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    for (const glm::vec3& corner : {a, b, c}) {
      sphere.indices.push_back(static_cast<std::uint32_t>(sphere.positions.size()));
      sphere.positions.push_back(corner);
      sphere.normals.push_back(normal);
    }
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < 2 * rings; ++step) {
      // At the poles one triangle of the facet has no area.
      if (ring > 0) add(at(ring, step), at(ring, step + 1), at(ring + 1, step));
      if (ring + 1 < rings) add(at(ring, step + 1), at(ring + 1, step + 1), at(ring + 1, step));
    }
  }
  place(scene, std::move(sphere));
}

inline void add_point_light(scene::Scene& scene, glm::dvec3 position, glm::vec3 intensity) {
  scene::Light light;
  light.kind = scene::LightKind::point;
  light.position = position;
  light.intensity = intensity;
  scene.lights.push_back(light);
}

inline void add_spot_light(scene::Scene& scene, glm::dvec3 position, glm::dvec3 direction, glm::vec3 intensity,
                           double inner_rad, double outer_rad) {
  scene::Light light;
  light.kind = scene::LightKind::spot;
  light.position = position;
  light.direction = glm::normalize(direction);
  light.intensity = intensity;
  light.inner_rad = inner_rad;
  light.outer_rad = outer_rad;
  scene.lights.push_back(light);
}

/// `irradiance`: W/m² on a plane that faces the light.
inline void add_directional_light(scene::Scene& scene, glm::dvec3 direction, glm::vec3 irradiance) {
  scene::Light light;
  light.kind = scene::LightKind::directional;
  light.direction = glm::normalize(direction);
  light.intensity = irradiance;
  scene.lights.push_back(light);
}

inline scene::Camera look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up = {0, 1, 0}, double yfov_rad = .7) {
  scene::Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = up;
  camera.yfov_rad = yfov_rad;
  return camera;
}

/// To be called when a scene is complete: caches are keyed by the hash.
inline void finish(scene::Scene& scene) { scene.content_hash = scene::content_hash(scene); }

}  // namespace loom::test
