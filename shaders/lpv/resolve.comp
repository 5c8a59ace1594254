// The sum over all steps and orders of one channel, as a filterable volume. VOLUME and CHANNEL are given by the pass: a
// channel that nobody reads is not made.
#include "lpv/cells.glsl"
layout(local_size_x = 32, local_size_y = 1, local_size_z = 1) in;

layout(rgba32f) uniform writeonly image3D VOLUME;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  imageStore(VOLUME, cell, sum[CHANNEL * cell_count() + grid_index(grid, cell)]);
}
