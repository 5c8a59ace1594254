#pragma once
// Where the probes stand.
#include <cstdint>
#include <span>
#include <vector>

#include "interop/probes.h"
#include "loom/rules.h"

namespace field {

struct GridOptions {
  int probes = 8;     ///< along the longest side of the scene's box
  double inset = .1;  ///< distance of the outermost probes from the box, in grid steps
  int coefficients = 9;
  int moments = 8;     ///< side of a probe's octahedral map
  double behind = .2;  ///< weight of a probe behind the surface
};

/// A grid over the scene's box: nearly cubic steps, at least two probes along each axis.
loom::interop::ProbeGrid fit_probes(const loom::rules::Bounds& box, const GridOptions& options);

/// Probes that GatherProbes may read for points in cells, [z][y][x] of the probe at their lower corner, where `cells`
/// is not 0: those of the cell and, where none of these sees the point, their neighbours (shaders/lib/probes.glsl).
std::vector<std::int32_t> read_by(const loom::interop::ProbeGrid& grid, std::span<const std::uint32_t> cells);

/// Length of the shortest step, metres.
double shortest_step(const loom::interop::ProbeGrid& grid);

}  // namespace field
