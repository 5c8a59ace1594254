// A grid of cubic cells, or nested grids of one resolution (cascades, finest first). The bundle struct of ShVolume and
// VoxelScene. Cascade k occupies slices [k·cells.z, (k+1)·cells.z) of a volume texture.
#ifndef LOOM_INTEROP_GRID_H
#define LOOM_INTEROP_GRID_H
#include "interop/interop.h"
#define LOOM_MAX_CASCADES 8
LOOM_INTEROP_BEGIN
struct Grid {
  ivec4 cells;                       // xyz: cells of one cascade, w: cascades
  vec4 cascade[LOOM_MAX_CASCADES];   // xyz: world position of the lower corner, w: cell size s, metres
};
LOOM_STRUCT_SIZE(Grid, 144);
LOOM_INTEROP_END
#endif
