// Mean radiance of the probes that are on: over the sphere a probe's is c00·Y00, or Σ a_i·I_0/2 of its Gaussians.
#include "interop/probes.h"
#include "lib/math.glsl"
#include "lib/sh.glsl"
#if GAUSSIANS
#include "lib/spherical_gaussians.glsl"
#endif
layout(local_size_x = 64) in;
layout(std140) uniform field_data { ProbeGrid grid; };
uniform sampler2DArray field_coefficients;
uniform sampler3D field_state;
layout(rgba32f) uniform writeonly image2D scratch_ambient;

shared vec4 sums[64];

vec3 mean_radiance(ivec3 probe) {
#if GAUSSIANS
  vec3 sum = vec3(0);
  for (int i = 0; i < COEFFICIENTS; ++i)
    sum += texelFetch(field_coefficients, ivec3(probe.x * COEFFICIENTS + i, probe.yz), 0).rgb;
  return sum * ((1. - exp(-2. * sg_sharpness)) / (2. * sg_sharpness));
#else
  return SH_Y0 * texelFetch(field_coefficients, ivec3(probe.x * COEFFICIENTS, probe.yz), 0).rgb;
#endif
}

void main() {
  int first = int(gl_LocalInvocationIndex);
  ivec3 counts = grid.counts.xyz;
  vec4 sum = vec4(0);
  for (int i = first; i < counts.x * counts.y * counts.z; i += 64) {
    ivec3 probe = ivec3(i % counts.x, i / counts.x % counts.y, i / (counts.x * counts.y));
    if (texelFetch(field_state, probe, 0).w > .5) sum += vec4(mean_radiance(probe), 1);
  }
  sums[first] = sum;
  barrier();
  if (first > 0) return;
  for (int i = 1; i < 64; ++i) sum += sums[i];
  imageStore(scratch_ambient, ivec2(0), vec4(sum.rgb / max(sum.a, 1.), 1));
}
