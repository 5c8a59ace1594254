#include "probe_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/common.hpp>
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

std::vector<std::int32_t> read_by(const loom::interop::ProbeGrid& grid, std::span<const std::uint32_t> cells) {
  const glm::ivec3 counts(grid.counts);
  const auto index = [&](glm::ivec3 p) { return p.x + counts.x * (p.y + counts.y * p.z); };
  const auto any_read = [&](glm::ivec3 probe) {
    const glm::ivec3 low = glm::max(probe - 2, glm::ivec3(0)), high = glm::min(probe + 1, counts - 1);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x)
          if (cells[static_cast<std::size_t>(index({x, y, z}))] != 0) return true;
      }
    }
    return false;
  };
  std::vector<std::int32_t> probes;
  for (int z = 0; z < counts.z; ++z) {
    for (int y = 0; y < counts.y; ++y) {
      for (int x = 0; x < counts.x; ++x)
        if (any_read({x, y, z})) probes.push_back(index({x, y, z}));
    }
  }
  return probes;
}

double shortest_step(const loom::interop::ProbeGrid& grid) {
  return std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
}

}  // namespace field
