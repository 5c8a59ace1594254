// Level 0 of the pyramid of power: each cell's six sides.
#include "lib/exitant_sheets.glsl"
// After what sheets send out is known.
#include "lib/voxels.glsl"
#include "ray_march/power.glsl"
layout(local_size_x = 32) in;

layout(r32f) uniform writeonly image3D scratch_power;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  float sum = 0.;
  if (texelFetch(voxels_coverage, cell, 0).w > 0.) {
    for (int slab = 0; slab < 6; ++slab) sum += side_power(cell, slab);
  }
  imageStore(scratch_power, cell, vec4(sum));
}
