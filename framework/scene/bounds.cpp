#include "scene/bounds.h"

#include <cstddef>

#include <oneapi/tbb/parallel_for.h>

namespace loom::scene {

std::vector<Box> instance_boxes(const Scene& scene) {
  std::vector<Box> boxes(scene.instances.size());
  oneapi::tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t i) {
    const Instance& instance = scene.instances[i];
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      for (const glm::vec3& position : primitive.positions) {
        boxes[i].add(glm::dvec3(instance.world * glm::dvec4(glm::dvec3(position), 1)));
      }
    }
  });
  return boxes;
}

Box scene_box(const Scene& scene) {
  Box all;
  for (const Box& box : instance_boxes(scene)) {
    if (box.empty()) continue;
    all.add(box.low);
    all.add(box.high);
  }
  return all;
}

}  // namespace loom::scene
