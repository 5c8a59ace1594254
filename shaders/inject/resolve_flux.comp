// Adds one source's fixed-point sums to the volumes. A channel that nobody reads is not made.
#include "inject/inject.glsl"
#include "lib/storage.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

#if RED
layout(STORAGE_RGBA) uniform image3D flux_red;
#endif
#if GREEN
layout(STORAGE_RGBA) uniform image3D flux_green;
#endif
#if BLUE
layout(STORAGE_RGBA) uniform image3D flux_blue;
#endif
layout(std430) readonly buffer scratch_fixed { int fixed_flux[]; };
layout(std430) readonly buffer scratch_scale { float flux_scale; };

vec4 sum_of(int channel, ivec3 cell) {
  vec4 c;
  for (int i = 0; i < 4; ++i) {
    c[i] = float(fixed_flux[(4 * channel + i) * cell_count() + grid_index(grid, cell)]) / flux_scale;
  }
  return c;
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz)) || !(flux_scale > 0.0)) return;
  ivec3 to = volume_texel(cell);
#if RED
  imageStore(flux_red, to, stored(imageLoad(flux_red, to) + sum_of(0, cell)));
#endif
#if GREEN
  imageStore(flux_green, to, stored(imageLoad(flux_green, to) + sum_of(1, cell)));
#endif
#if BLUE
  imageStore(flux_blue, to, stored(imageLoad(flux_blue, to) + sum_of(2, cell)));
#endif
}
