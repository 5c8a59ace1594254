// A stage of propagation as a compute shader: one invocation a cell and channel. Neighbours along x share what is cached,
// so that a work group is as long as the grid, up to 32 cells.
// Volumes are read as images: a texel fetch, which also has a level to choose, takes half as long again on llvmpipe.
#define STATE layout(STORAGE_RGBA) uniform readonly image3D
#define BITS layout(rgba32ui) uniform readonly uimage3D
#define READ(volume, at) imageLoad(volume, at)
#include "lpv/stage.glsl"
layout(local_size_x = ROW, local_size_y = 32 / ROW) in;

#if STAGE != REFLECT
layout(STORAGE_RGBA) uniform writeonly image3D TO;
layout(rgba32f) uniform image3D scratch_sum;
#endif
#if BLOCKERS && STAGE != BEGIN
layout(rgba32f) uniform image3D scratch_blocked;
#endif

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel, grid.cells.xyz * ivec3(1, 1, CHANNELS)))) return;
  Result result = stage(texel);
#if STAGE == BEGIN
  imageStore(TO, texel, stored(result.front));
  imageStore(scratch_sum, texel, order == 0 ? result.sum : imageLoad(scratch_sum, texel) + result.sum);
#elif STAGE == REFLECT
#if BLOCKERS
  imageStore(scratch_blocked, texel, result.blocked);
#endif
#else
  imageStore(TO, texel, stored(result.front));
  imageStore(scratch_sum, texel, imageLoad(scratch_sum, texel) + result.sum);
#if BLOCKERS
  imageStore(scratch_blocked, texel, imageLoad(scratch_blocked, texel) + result.blocked);
#endif
#endif
}
