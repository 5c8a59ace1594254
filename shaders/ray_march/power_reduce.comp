// One level of the pyramid of power from the finer one.
#include "interop/grid.h"
#include "ray_march/pyramid.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140) uniform voxels_data { Grid grid; };
layout(r32f) uniform image3D scratch_power;
uniform int level;

void main() {
  ivec3 id = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(id, level_cells(grid.cells.xyz, level)))) return;
  ivec3 finer = level_cells(grid.cells.xyz, level - 1), from = level_corner(grid.cells.xyz, level - 1, 0);
  float sum = 0.;
  for (int i = 0; i < 8; ++i) {
    ivec3 child = 2 * id + ivec3(i & 1, (i >> 1) & 1, i >> 2);
    if (all(lessThan(child, finer))) sum += imageLoad(scratch_power, from + child).r;
  }
  imageStore(scratch_power, level_corner(grid.cells.xyz, level, 0) + id, vec4(sum));
}
