#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/bounds.h"
#include "scene/load.h"
#include "scene/scene.h"

namespace loom::scene {

void recentre(Scene& scene) {
  const Box box = scene_box(scene);
  const double diagonal = glm::length(box.extent());
  const glm::dvec3 centre = box.centre();
  if (!(diagonal > 0 && glm::length(centre) > 8 * diagonal)) return;
  const double step = std::exp2(std::ceil(std::log2(diagonal)));
  const glm::dvec3 origin = step * glm::round(centre / step);
  // What a node carries follows its node; the rest (a run file's lights) is moved here.
  std::vector<char> carried(scene.lights.size(), 0);
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) carried[static_cast<std::size_t>(node.light)] = 1;
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (carried[i] == 0) scene.lights[i].position -= origin;
  }
  scene.origin += origin;
  pose(scene, 0);
}

}  // namespace loom::scene
