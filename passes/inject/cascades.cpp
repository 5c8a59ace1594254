#include "cascades.h"

#include <cmath>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace inject {

using glm::dvec3;
using loom::interop::Camera;
using loom::interop::Grid;

Grid place_cascades(const Grid& coarsest, int count, const Camera& camera) {
  Grid grid = coarsest;
  grid.cells.w = count;
  const dvec3 corner(coarsest.cascade[0]);
  const double n = coarsest.cells.x;
  for (int k = 0; k < count; ++k) {
    const double s = std::ldexp(static_cast<double>(coarsest.cascade[0].w), k + 1 - count);
    const dvec3 centre = dvec3(camera.eye) + .25 * n * s * dvec3(camera.forward);
    // In cells of this cascade from the coarsest grid's corner.
    const dvec3 last(n * (std::ldexp(1., count - 1 - k) - 1));
    const dvec3 cell = glm::clamp(glm::floor((centre - corner) / s - .5 * n + .5), dvec3(0), last);
    grid.cascade[k] = glm::vec4(glm::vec3(corner + s * cell), static_cast<float>(s));
  }
  return grid;
}

}  // namespace inject
