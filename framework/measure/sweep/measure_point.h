#pragma once
// One point of a sweep, measured in this process: it must be a fresh one, with no OpenGL context of its own.
#include <string>
#include <vector>

#include "loom/export.h"
#include "loom/registry.h"
#include "measure/sweep/expand.h"
#include "measure/sweep/result.h"
#include "measure/sweep/sweep.h"

namespace loom::measure {

struct PointJob {
  const Sweep& sweep;
  const Point& point;
  const Registry& registry;
  std::vector<std::string> shader_roots;
  std::string truth_folder;
  std::string pictures;  ///< folder for <key>.png, and <key>.error.png in magma; empty: none
  std::string version;   ///< of the program
};

/// What a result says of the point before it is measured.
LOOM_API Result describe(const Sweep& sweep, const Point& point);

/// Renders, times and compares. Throws where that cannot be done.
LOOM_API Result measure_point(const PointJob& job);

/// Everything that the figures of a point come from: what its scene holds, its pipeline's files, and the program with
/// its passes and shaders. Figures of another one are out of date.
LOOM_API std::string content_of(const Sweep& sweep, const Point& point, const std::string& truth_id,
                                const std::vector<std::string>& shader_roots);

}  // namespace loom::measure
