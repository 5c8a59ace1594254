#pragma once
// The grid that passes lay over a scene.
#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/grid.h"
#include "loom/formats.h"
#include "loom/rules.h"

namespace loom {

/// `box`: the shorter sides have as many cells as they need; `cube`: as many as the longest.
enum class GridShape { box, cube };

/// Cubic cells around a box, `n` along its longest side, with one empty cell at each end: no surface lies
/// outside, and the two outermost faces of a wall at the border exist.
inline interop::Grid fit_grid(const rules::Bounds& box, int n, GridShape shape = GridShape::box) {
  const glm::dvec3 extent = box.high - box.low;
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
  const double s = n > 2 ? longest / (n - 2) : longest;
  interop::Grid grid{};
  glm::dvec3 cells;
  for (int axis = 0; axis < 3; ++axis) {
    // A ten-thousandth of a cell is no reason for one more.
    const bool fewer = shape == GridShape::box && n > 2;
    cells[axis] = fewer ? std::clamp(std::ceil(extent[axis] / s - 1e-4) + 2., 3., static_cast<double>(n)) : n;
    grid.cells[axis] = static_cast<int>(cells[axis]);
  }
  grid.cells.w = 1;
  const glm::dvec3 lower = .5 * (box.low + box.high) - .5 * s * cells;
  grid.cascade[0] = glm::vec4(glm::vec3(lower), static_cast<float>(s));
  return grid;
}

/// A volume of one texel a cell, or of several slabs of them one behind the other.
inline TextureDesc cell_texture(const interop::Grid& grid, Format format, int slabs = 1) {
  return {.format = format,
          .kind = TextureKind::d3,
          .width = grid.cells.x,
          .height = grid.cells.y,
          .depth = grid.cells.z * slabs,
          .filter = Filter::nearest};
}

}  // namespace loom
