#include "probe_grid.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace field {

loom::interop::ProbeGrid fit_probes(const loom::rules::Bounds& box, const GridOptions& options) {
  const glm::dvec3 extent = box.high - box.low;
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
  const double step = longest / (options.probes - 1 + 2 * options.inset);
  loom::interop::ProbeGrid grid{};
  for (int axis = 0; axis < 3; ++axis) {
    const double gaps = std::max(1., std::round(extent[axis] / step - 2 * options.inset));
    // A box flatter than a step gets a probe on each side.
    const double spacing = std::max(extent[axis], step) / (gaps + 2 * options.inset);
    const double middle = .5 * (box.low[axis] + box.high[axis]);
    grid.counts[axis] = static_cast<int>(gaps) + 1;
    grid.spacing[axis] = static_cast<float>(spacing);
    grid.lower[axis] = static_cast<float>(middle - .5 * gaps * spacing);
  }
  grid.counts.w = options.coefficients;
  // A receiver is at most a cell's diagonal away from a grid point, two where the search is wider.
  grid.spacing.w = static_cast<float>(2 * glm::length(glm::dvec3(grid.spacing)));
  grid.weights = {static_cast<float>(options.moments), static_cast<float>(options.behind), 0, 0};
  return grid;
}

double shortest_step(const loom::interop::ProbeGrid& grid) {
  return std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
}

}  // namespace field
