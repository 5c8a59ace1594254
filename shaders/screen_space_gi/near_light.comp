// E = π·(Σ L of fronts and of what is taken for hidden sides) + E_far · (share of rays that found nothing)
#define HIDDEN_front 0
#define HIDDEN_far 1
#define HIDDEN_dark 2
#include "interop/frame.h"
#define RADIANCE 1
#if ENDED
const bool hidden_ends = HIDDEN != HIDDEN_far;
#endif
vec3 front_radiance(ivec2 texel);
#include "lib/screen_rays.glsl"

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D radiance_image;
#if FAR
uniform sampler2D far_irradiance;
#endif

#if ENDED
layout(rgba32f) writeonly uniform image2DArray ended_image;
#endif

vec3 front_radiance(ivec2 texel) { return texelFetch(radiance_image, texel, 0).rgb; }

vec3 irradiance_at(ivec2 pixel) {
  ScreenPoint x = screen_point(camera, pixel, texelFetch(surface_depth, pixel, 0).r);
  uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x6e656172u);
  ScreenRays rays = screen_rays(camera, x, seed, frame.random.z);
#if ENDED
  for (int i = 0; i < 3; ++i) imageStore(ended_image, ivec3(pixel, i), rays.ended[i]);
#endif
  float unknown = max(0., 1. - rays.front - rays.hidden - rays.under);
  vec3 e = pi * rays.radiance;
#if HIDDEN == HIDDEN_front
  e += pi * rays.behind;
#elif HIDDEN == HIDDEN_far
  unknown += rays.hidden;
#endif
#if FAR
  e += unknown * texelFetch(far_irradiance, pixel, 0).rgb;
#endif
  return e;
}

#include "lib/resolution.glsl"
