// Adds one source's fixed-point sums to the volumes, then clears them. A channel that nobody reads is not made.
#include "inject/inject.glsl"
layout(local_size_x = 32) in;

#if RED
layout(rgba32f) uniform image3D flux_red;
#endif
#if GREEN
layout(rgba32f) uniform image3D flux_green;
#endif
#if BLUE
layout(rgba32f) uniform image3D flux_blue;
#endif
layout(std430) buffer scratch_fixed { int fixed_flux[]; };
layout(std430) readonly buffer scratch_scale { float flux_scale; };

vec4 take(int channel, ivec3 cell) {
  vec4 c;
  for (int i = 0; i < 4; ++i) {
    int at = (4 * channel + i) * cell_count() + grid_index(grid, cell);
    c[i] = float(fixed_flux[at]) / flux_scale;
    fixed_flux[at] = 0;
  }
  return c;
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz)) || !(flux_scale > 0.0)) return;
  ivec3 to = volume_texel(cell);
  vec4 red = take(0, cell), green = take(1, cell), blue = take(2, cell);
#if RED
  imageStore(flux_red, to, imageLoad(flux_red, to) + red);
#endif
#if GREEN
  imageStore(flux_green, to, imageLoad(flux_green, to) + green);
#endif
#if BLUE
  imageStore(flux_blue, to, imageLoad(flux_blue, to) + blue);
#endif
}
