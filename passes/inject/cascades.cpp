#include "cascades.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace inject {

using glm::dvec3;
using loom::interop::Camera;
using loom::interop::Grid;

Grid fit_grid(const loom::SceneFacts& facts, int n) {
  const dvec3 extent = facts.bounds_max - facts.bounds_min;
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
  const double s = n > 2 ? longest / (n - 2) : longest;
  const dvec3 lower = .5 * (facts.bounds_min + facts.bounds_max) - dvec3(.5 * s * n);
  Grid grid{};
  grid.cells = {n, n, n, 1};
  grid.cascade[0] = glm::vec4(glm::vec3(lower), static_cast<float>(s));
  return grid;
}

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
