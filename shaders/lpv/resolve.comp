// The sum over all steps and orders, as filterable volumes.
#include "lpv/cells.glsl"
layout(local_size_x = 32, local_size_y = 1, local_size_z = 1) in;

layout(rgba32f) uniform writeonly image3D intensity_red;
layout(rgba32f) uniform writeonly image3D intensity_green;
layout(rgba32f) uniform writeonly image3D intensity_blue;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  int n = cell_count(), i = grid_index(grid, cell);
  imageStore(intensity_red, cell, sum[i]);
  imageStore(intensity_green, cell, sum[n + i]);
  imageStore(intensity_blue, cell, sum[2 * n + i]);
}
