// E = π · L_ambient · share of the rays that nothing stops within the radius
#include "interop/frame.h"
#define RADIANCE 0
#define ENDED 0
#include "lib/screen_rays.glsl"

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
#if FIELD
uniform sampler2D scratch_ambient;
#else
uniform vec3 ambient;
#endif

vec3 irradiance_at(ivec2 pixel) {
  ScreenPoint x = screen_point(camera, pixel, texelFetch(surface_depth, pixel, 0).r);
  ScreenRays rays = screen_rays(camera, x, pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x616fu), frame.random.z);
  float open = max(0., 1. - rays.front - rays.hidden - rays.under);
#if FIELD
  vec3 ambient = max(vec3(0), texelFetch(scratch_ambient, ivec2(0), 0).rgb);
#endif
  return pi * open * ambient;
}

#include "lib/resolution.glsl"
