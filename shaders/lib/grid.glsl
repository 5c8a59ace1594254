// Cells of a Grid.
#ifndef LOOM_LIB_GRID_GLSL
#define LOOM_LIB_GRID_GLSL
#include "interop/grid.h"

// Continuous cell coordinates of a world position: cell i spans [i, i+1).
vec3 grid_coordinates(Grid grid, int cascade, vec3 position) {
  return (position - grid.cascade[cascade].xyz) / grid.cascade[cascade].w;
}

// The cell that holds a position, false outside. Not a clamp: that would pile outside points into the border cells.
bool grid_cell(Grid grid, int cascade, vec3 position, out ivec3 cell) {
  vec3 w = grid_coordinates(grid, cascade, position);
  cell = ivec3(0);
  // Written so that a NaN fails it.
  if (!(all(greaterThanEqual(w, vec3(0))) && all(lessThanEqual(w, vec3(grid.cells.xyz))))) return false;
  cell = min(ivec3(floor(w)), grid.cells.xyz - 1);
  return true;
}

int grid_index(Grid grid, ivec3 cell) { return cell.x + grid.cells.x * (cell.y + grid.cells.y * cell.z); }

#endif
