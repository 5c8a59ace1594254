// The sum over all steps and orders of one cascade, as SH. A channel that nobody reads is not made.
#include "lpv/state.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

uniform sampler3D scratch_sum;
#if RED
layout(STORAGE_RGBA) uniform writeonly image3D intensity_red;
#endif
#if GREEN
layout(STORAGE_RGBA) uniform writeonly image3D intensity_green;
#endif
#if BLUE
layout(STORAGE_RGBA) uniform writeonly image3D intensity_blue;
#endif
uniform int cascade;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  ivec3 channel = ivec3(0, 0, grid.cells.z), to = cell + cascade * channel;
#if RED
  imageStore(intensity_red, to, stored(to_sh(texelFetch(scratch_sum, cell, 0))));
#endif
#if GREEN
  imageStore(intensity_green, to, stored(to_sh(texelFetch(scratch_sum, cell + channel, 0))));
#endif
#if BLUE
  imageStore(intensity_blue, to, stored(to_sh(texelFetch(scratch_sum, cell + 2 * channel, 0))));
#endif
}
