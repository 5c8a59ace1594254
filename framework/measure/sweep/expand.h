#pragma once
// From a sweep to its points: every scene with every pipeline at every place of the pipeline's grid.
#include <cstddef>
#include <string>
#include <vector>

#include "graph/compile/compile.h"
#include "loom/export.h"
#include "loom/registry.h"
#include "measure/sweep/sweep.h"

namespace loom::measure {

struct Point {
  std::string key;                   ///< of what the sweep says about it: names its result file
  std::size_t scene = 0, entry = 0;  ///< into Sweep::scenes and Sweep::pipelines
  std::vector<graph::Override> set;  ///< a value for each knob, as JSON text
};

/// The points in the order in which they are measured: one of each scene and pipeline in turn, so that a machine that
/// slows down or warms up favours none. The same sweep gives the same points and keys everywhere. Throws BadInput where
/// a pipeline has no such parameter, a value is outside its range, or the pipeline cannot be measured.
LOOM_API std::vector<Point> expand(const Sweep& sweep, const Registry& registry);

/// Every n-th point, beginning with the i-th; i counts from 1.
LOOM_API std::vector<Point> shard(const std::vector<Point>& points, int i, int n);

/// The size of a scene's pictures in this sweep.
LOOM_API glm::ivec2 size_of(const Sweep& sweep, const SweepScene& scene);

}  // namespace loom::measure
