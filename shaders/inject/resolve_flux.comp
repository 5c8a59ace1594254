// Adds one light's fixed-point sums of one channel to its volume, then clears them. VOLUME and CHANNEL are given by the
// pass: a channel that nobody reads is not made.
#include "inject/inject.glsl"
layout(local_size_x = 32) in;

layout(rgba32f) uniform image3D VOLUME;
layout(std430) buffer scratch_fixed { int fixed_flux[]; };
uniform float flux_scale;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  vec4 c = imageLoad(VOLUME, cell);
  for (int i = 0; i < 4; ++i) {
    int at = (4 * CHANNEL + i) * cell_count() + grid_index(grid, cell);
    c[i] += float(fixed_flux[at]) / flux_scale;
    fixed_flux[at] = 0;
  }
  imageStore(VOLUME, cell, c);
}
