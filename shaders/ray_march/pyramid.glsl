// The voxelized scene seen from the six axis directions, at ever coarser cells: of each cell what it sends towards one
// direction (radiance, premultiplied) and how much it blocks of what comes from behind (a). One volume holds it all: slab
// d along z is direction d = 2·axis + side, and level l begins at x = 2·(n − n/2ˡ).
// After Crassin et al., "Interactive Indirect Illumination Using Voxel Cone Tracing", 2011.
#ifndef LOOM_RAY_MARCH_PYRAMID_GLSL
#define LOOM_RAY_MARCH_PYRAMID_GLSL

// Cells of level l, for n at level 0.
ivec3 level_cells(ivec3 n, int level) { return max((n + (1 << level) - 1) >> level, ivec3(1)); }

// Where the block of a level and direction begins in the volume.
ivec3 level_corner(ivec3 n, int level, int slab) {
  int x = 0;
  for (int l = 0; l < level; ++l) x += level_cells(n, l).x;
  return ivec3(x, 0, slab * n.z);
}
#endif
