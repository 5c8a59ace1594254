#pragma once
// Scenes built by hand, of few triangles, whose answers are known.
#include <cstdint>
#include <random>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/scene.h"

namespace loom::test {

/// A parallelogram a, a+u, a+u+v, a+v with front normal u × v and texture coordinates (0,0) at a, (1,0) at a+u.
inline scene::Primitive quad(glm::vec3 a, glm::vec3 u, glm::vec3 v, int material = 0) {
  scene::Primitive primitive;
  primitive.positions = {a, a + u, a + u + v, a + v};
  primitive.normals.assign(4, glm::normalize(glm::cross(u, v)));
  primitive.uv0 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  primitive.indices = {0, 1, 2, 0, 2, 3};
  primitive.material = material;
  return primitive;
}

/// A scene with one white material and nothing in it.
inline scene::Scene empty_scene() {
  scene::Scene scene;
  scene.materials.emplace_back();
  return scene;
}

/// Adds the primitive as a mesh with one instance.
inline void place(scene::Scene& scene, scene::Primitive primitive, const glm::dmat4& world = glm::dmat4(1)) {
  scene.meshes.push_back({.primitives = {std::move(primitive)}});
  scene.nodes.push_back({.world = world, .mesh = static_cast<int>(scene.meshes.size()) - 1});
  scene.instances.push_back({.mesh = static_cast<int>(scene.meshes.size()) - 1,
                             .node = static_cast<int>(scene.nodes.size()) - 1,
                             .world = world});
}

inline int add_material(scene::Scene& scene, scene::Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<int>(scene.materials.size()) - 1;
}

/// `count` triangles of about `size`, spread over the cube [−extent, extent]³.
inline scene::Primitive random_triangles(int count, float extent, float size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto vector = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  scene::Primitive primitive;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 centre = extent * vector();
    for (int k = 0; k < 3; ++k) {
      primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
      primitive.positions.push_back(centre + size * vector());
      primitive.normals.emplace_back(0, 1, 0);
    }
  }
  return primitive;
}

}  // namespace loom::test
