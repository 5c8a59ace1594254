// E(x) = Σ L ∫ V ⟨n,ω⟩₊ dω over emissive triangles, and over the sky.
#include "interop/frame.h"
#include "lib/area_light.glsl"
#include "lib/camera.glsl"
#include "lib/parts.glsl"
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform int samples;

vec3 irradiance_at(ivec2 pixel) {
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 irradiance = vec3(0);
  Receiver r;
  r.x = surface_position(camera, pixel_uv(camera, pixel), depth);
  r.n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  r.n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  r.depth = depth;
  r.seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x61726561u);
  r.sequence = stretch_of_part(frame.random.z);
#if EMITTERS != EMITTERS_none
  irradiance += emitter_irradiance(r, samples_of_part(samples), 4);
#endif
#if SKY
  irradiance += sky_irradiance(r, frame.sky, samples_of_part(samples), float(samples) * float(frame.random.w));
#endif
  return irradiance;
}

#include "lib/resolution.glsl"
