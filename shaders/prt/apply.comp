// What arrives at a point of the lattice under the environment of the frame: L'_i = Σ_j M_ij·L_j, with the part of M that
// PART takes: straight light, or what has been reflected.
#include "prt/lattice.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer scratch_baked { vec4 baked[]; };
layout(std430) readonly restrict buffer scratch_environment { vec4 environment[]; };
uniform int first_coefficient;  // of the environment of this output
#if COEFFICIENTS_OUT
writeonly uniform image2DArray COEFFICIENTS_IMAGE;
#endif
#if MOMENTS_OUT
layout(rg32f) writeonly uniform image2DArray MOMENTS_IMAGE;
#endif
#if STATE_OUT
layout(rgba32f) writeonly uniform image3D STATE_IMAGE;
#endif

void main() {
  int point = int(gl_GlobalInvocationID.x);
  if (point >= point_count() || state_of(point) >= baked.length()) return;
  if (first_coefficient + COEFFICIENTS > environment.length()) return;
  ivec3 at = point_at(point);
#if STATE_OUT
  imageStore(STATE_IMAGE, at, baked[state_of(point)]);
#endif
#if COEFFICIENTS_OUT
  for (int i = 0; i < COEFFICIENTS; ++i) {
    vec3 sum = vec3(0);
    for (int j = 0; j < COEFFICIENTS; ++j) {
      sum += baked[matrix_of(point) + i * COEFFICIENTS + j].PART * environment[first_coefficient + j].rgb;
    }
    imageStore(COEFFICIENTS_IMAGE, ivec3(at.x * COEFFICIENTS + i, at.yz), vec4(sum, 0));
  }
#endif
#if MOMENTS_OUT
  for (int t = 0; t < moments * moments; ++t) {
    ivec3 texel = ivec3(at.xy * moments + ivec2(t % moments, t / moments), at.z);
    imageStore(MOMENTS_IMAGE, texel, vec4(baked[moments_of(point) + t].xy, 0, 0));
  }
#endif
}
