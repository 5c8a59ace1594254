#pragma once
// Where the points of the lattice stand.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "interop/probes.h"
#include "loom/rules.h"

namespace prt {

struct LatticeOptions {
  int points = 8;     ///< along the longest side of the box
  double inset = .1;  ///< of the outermost points from the box, in steps
  int coefficients = 9;
  int moments = 8;
};

/// Nearly cubic steps, at least two points along each axis.
inline loom::interop::ProbeGrid fit_lattice(const loom::rules::Bounds& box, const LatticeOptions& options) {
  const glm::dvec3 extent = box.high - box.low;
  const double step = std::max({extent.x, extent.y, extent.z, 1e-30}) / (options.points - 1 + 2 * options.inset);
  loom::interop::ProbeGrid grid{};
  for (int axis = 0; axis < 3; ++axis) {
    const double gaps = std::max(1., std::round(extent[axis] / step - 2 * options.inset));
    // A box flatter than a step gets a point on each side.
    const double spacing = std::max(extent[axis], step) / (gaps + 2 * options.inset);
    grid.counts[axis] = static_cast<int>(gaps) + 1;
    grid.spacing[axis] = static_cast<float>(spacing);
    grid.lower[axis] = static_cast<float>(.5 * (box.low[axis] + box.high[axis]) - .5 * gaps * spacing);
  }
  grid.counts.w = options.coefficients;
  // Two diagonals of a cell: what lies farther off hides nothing from a receiver that reads the point.
  grid.spacing.w = static_cast<float>(2 * glm::length(glm::dvec3(grid.spacing)));
  grid.weights = {static_cast<float>(options.moments), 0, 0, 0};
  return grid;
}

}  // namespace prt
