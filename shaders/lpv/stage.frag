// A stage of propagation as a fragment shader: volumes are layered targets, and sums are made by blending.
#define STATE uniform sampler3D
#define BITS uniform usampler3D
#define READ(volume, at) texelFetch(volume, at, 0)
#include "lpv/stage.glsl"

#if STAGE == REFLECT
layout(location = 0) out vec4 out_blocked;
#else
layout(location = 0) out vec4 out_front;
layout(location = 1) out vec4 out_sum;
#if BLOCKERS && STAGE == STEP
layout(location = 2) out vec4 out_blocked;
#endif
#endif

void main() {
  Result result = stage(ivec3(gl_FragCoord.xy, gl_Layer));
#if STAGE != REFLECT
  out_front = stored(result.front);
  out_sum = result.sum;
#endif
#if BLOCKERS && STAGE != BEGIN
  out_blocked = result.blocked;
#endif
}
