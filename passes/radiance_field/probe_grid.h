#pragma once
// Where the probes stand.
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

/// Length of the shortest step, metres.
double shortest_step(const loom::interop::ProbeGrid& grid);

}  // namespace field
