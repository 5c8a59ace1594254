#pragma once
// The triangles of a posed scene in world space.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/export.h"
#include "scene/bounds.h"
#include "scene/scene.h"

namespace loom::scene {

/// True where the transform turns counter-clockwise into clockwise.
inline bool mirrors(const glm::dmat4& world) { return glm::determinant(glm::dmat3(world)) < 0; }

/// A triangle at its place: corners in metres, counter-clockwise seen from the front whatever the transform.
struct WorldTriangle {
  std::array<glm::dvec3, 3> corners;
  std::array<std::uint32_t, 3> vertices;  ///< indices into the primitive's arrays, in the order of `corners`
  const Primitive* primitive = nullptr;

  /// Twice the area vector: length 2·area, towards the front.
  [[nodiscard]] glm::dvec3 cross() const { return glm::cross(corners[1] - corners[0], corners[2] - corners[0]); }
};

/// Calls `visit(const WorldTriangle&)` for each triangle whose corners are finite.
template <class Visit>
void for_each_triangle(const Scene& scene, Visit&& visit) {
  for (const Instance& instance : scene.instances) {
    const bool mirrored = mirrors(instance.world);
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      const auto at = [&](std::uint32_t i) {
        return glm::dvec3(instance.world * glm::dvec4(glm::dvec3(primitive.positions[i]), 1));
      };
      for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        WorldTriangle triangle;
        triangle.vertices = {primitive.indices[i], primitive.indices[i + (mirrored ? 2 : 1)],
                             primitive.indices[i + (mirrored ? 1 : 2)]};
        triangle.primitive = &primitive;
        bool finite = true;
        for (std::size_t k = 0; k < 3; ++k) {
          triangle.corners[k] = at(triangle.vertices[k]);
          // Beyond the range of a float there is nothing to draw or hit.
          constexpr double largest = std::numeric_limits<float>::max();
          finite = finite && glm::all(glm::lessThanEqual(glm::abs(triangle.corners[k]), glm::dvec3(largest)));
        }
        if (finite) visit(static_cast<const WorldTriangle&>(triangle));
      }
    }
  }
}

/// The box of all triangles, metres.
LOOM_API Box world_box(const Scene& scene);

}  // namespace loom::scene
