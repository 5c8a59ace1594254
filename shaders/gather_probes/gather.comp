// Irradiance at each pixel from the eight probes around it.
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/math.glsl"
#include "lib/probes.glsl"
layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform field_data { ProbeGrid grid; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler2DArray field_coefficients;
uniform sampler2DArray field_moments;
uniform sampler3D field_state;

vec4 probe_state(ivec3 probe) { return texelFetch(field_state, probe, 0); }
vec2 probe_moments(ivec3 probe, ivec2 texel) {
  return texelFetch(field_moments, ivec3(probe.xy * moments_size(grid) + texel, probe.z), 0).rg;
}
vec3 probe_coefficient(ivec3 probe, int i) {
  return texelFetch(field_coefficients, ivec3(probe.x * COEFFICIENTS + i, probe.yz), 0).rgb;
}

vec3 irradiance_at(ivec2 pixel) {
  vec3 x = surface_position(camera, pixel_uv(camera, pixel), texelFetch(surface_depth, pixel, 0).r);
  vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  return probe_irradiance(grid, x, n, n_g);
}

#include "lib/resolution.glsl"
