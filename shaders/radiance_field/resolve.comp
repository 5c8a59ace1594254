// The sum over all orders, the moments and the states, as textures. Which of them are made is given by the pass.
#include "lib/storage.glsl"
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer ORDERS_BLOCK { Light orders[]; };
layout(std430) readonly restrict buffer MOMENTS_BLOCK { vec2 moments[]; };
#if COEFFICIENTS_OUT
writeonly uniform image2DArray field_coefficients;
#endif
#if MOMENTS_OUT
layout(rg32f) writeonly uniform image2DArray field_moments;
#endif
#if STATE_OUT
layout(rgba32f) writeonly uniform image3D field_state;
#endif
uniform int order_count;

void main() {
  int probe = int(gl_GlobalInvocationID.x), size = int(grid.weights.x);
  if (probe >= probe_count()) return;
  ivec3 at = probe_at(probe);
#if STATE_OUT
  imageStore(field_state, at, states[probe]);
#endif
#if COEFFICIENTS_OUT
  for (int i = 0; i < COEFFICIENTS; ++i) {
    vec3 sum = vec3(0);
    for (int order = 0; order < order_count; ++order) {
      sum += vec3(orders[(order * probe_count() + probe) * COEFFICIENTS + i]);
    }
    imageStore(field_coefficients, ivec3(at.x * COEFFICIENTS + i, at.yz), stored(vec4(sum, 0)));
  }
#endif
#if MOMENTS_OUT
  for (int t = 0; t < size * size; ++t) {
    imageStore(field_moments, ivec3(at.xy * size + ivec2(t % size, t / size), at.z),
               vec4(moments[probe * size * size + t], 0, 0));
  }
#endif
}
