// What the fragments of one sheet add up to. A sheet is the part of the scene inside one cell whose triangles have the
// same dominant axis. Fixed point: integer atomics are order-independent, so that the same frame twice is bit-identical.
#ifndef LOOM_VOXELIZE_SUMS_GLSL
#define LOOM_VOXELIZE_SUMS_GLSL
#include "interop/grid.h"
#include "lib/grid.glsl"

layout(std140) uniform voxels_data { Grid grid; };

// [axis][row][cell]; rows of a sheet:
const int ROW_AREA = 0;      // Σ a, in cell faces, opaque part alone
const int ROW_NORMAL = 1;    // Σ a·n, turned to the positive side of the axis
const int ROW_POSITION = 4;  // Σ a·(c − cell centre), in cells
const int ROW_BOX = 7;       // largest 255·(1−p), then 255·p, p from the cell's lower corner, in cells
const int ROW_SIDE = 13;     // of the positive and the negative side: Σ w, Σ w·(c − centre), Σ w·albedo
const int SIDE_ROWS = 7;
const int ROW_EMISSION = 27;  // of both sides: Σ w·L/L_max
const int ROW_LARGEST = SUM_ROWS - 1;  // the largest a, where COMBINE asks for it

// What of a sheet is opaque: of its section what the pieces' areas add up to, all wherever there is a piece (OR), or the
// largest piece's area (MAX).
const int COMBINE_SUM = 0, COMBINE_OR = 1, COMBINE_MAX = 2;
// SUMS: whose they are, scratch_sums or persistent_still.
layout(std430) buffer SUMS { int sums[]; };

// Units of a cell face. A cell may hold 500 times its face before a sum wraps.
const float FIXED = 4194304.;

int cell_count() { return grid.cells.x * grid.cells.y * grid.cells.z; }
int sum_index(ivec3 cell, int axis, int row) { return (axis * SUM_ROWS + row) * cell_count() + grid_index(grid, cell); }
#endif
