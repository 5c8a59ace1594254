// One level from the finer one: of the two cells one behind the other the front one covers the back one; the four such
// pairs side by side are averaged.
#include "interop/grid.h"
#include "lib/storage.glsl"
#include "ray_march/pyramid.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(std140) uniform voxels_data { Grid grid; };
layout(STORAGE_RGBA) uniform image3D scratch_pyramid;
uniform int level;

void main() {
  ivec3 n = grid.cells.xyz, cells = level_cells(n, level), finer = level_cells(n, level - 1);
  ivec3 id = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(id, cells * ivec3(1, 1, 6)))) return;
  int slab = id.z / cells.z, along = slab >> 1;
  ivec3 cell = ivec3(id.xy, id.z - slab * cells.z), from = level_corner(n, level - 1, slab);
  vec4 sum = vec4(0);
  for (int i = 0; i < 4; ++i) {
    ivec3 front = 2 * cell, across = ivec3(0);
    across[(along + 1) % 3] = i & 1;
    across[(along + 2) % 3] = i >> 1;
    front += across;
    ivec3 back = front;
    // What looks to the positive end is met there first.
    if ((slab & 1) == 0) front[along] += 1; else back[along] += 1;
    vec4 near = all(lessThan(front, finer)) ? imageLoad(scratch_pyramid, from + front) : vec4(0);
    vec4 far = all(lessThan(back, finer)) ? imageLoad(scratch_pyramid, from + back) : vec4(0);
    sum += .25 * (near + (1. - near.a) * far);
  }
  imageStore(scratch_pyramid, level_corner(n, level, slab) + cell, stored(sum));
}
