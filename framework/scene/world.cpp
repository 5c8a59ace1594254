#include "scene/world.h"

namespace loom::scene {

Box world_box(const Scene& scene) {
  Box box;
  for_each_triangle(scene, [&](const WorldTriangle& triangle) {
    for (const glm::dvec3& corner : triangle.corners) box.add(corner);
  });
  return box;
}

}  // namespace loom::scene
