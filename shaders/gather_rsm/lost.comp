// The light that the bound takes away, and what lies outside the radius: at every pixel.
#include "gather_rsm/gather.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
#if CLAMPED
writeonly uniform image2D clamped_irradiance;
#endif
#if MISSED
writeonly uniform image2D missed_irradiance;
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(surface_depth, 0)))) return;
  Gathered sums = Gathered(vec3(0), vec3(0), vec3(0));
  if (texelFetch(surface_depth, pixel, 0).r > 0.) sums = gathered_at(pixel);
#if CLAMPED
  imageStore(clamped_irradiance, pixel, vec4(sums.taken, 1));
#endif
#if MISSED
  imageStore(missed_irradiance, pixel, vec4(sums.missed, 1));
#endif
}
