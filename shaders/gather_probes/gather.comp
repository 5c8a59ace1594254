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

#if WITHOUT
uniform sampler2DArray without_image;

// Leaves the directions out for which a near field has answered: bands up to 2 as they are, of Gaussians the same share
// of each.
void take_out(ivec2 pixel, inout float basis[COEFFICIENTS]) {
#if GAUSSIANS
  float share = texelFetch(without_image, ivec3(pixel, 0), 0).x / .886226925;  // of √π/2 = π·Y00
  for (int i = 0; i < COEFFICIENTS; ++i) basis[i] *= 1. - share;
#else
  for (int i = 0; i < min(COEFFICIENTS, 9); ++i) basis[i] -= texelFetch(without_image, ivec3(pixel, i / 4), 0)[i % 4];
#endif
}
#endif

vec3 irradiance_at(ivec2 pixel) {
  vec3 x = surface_position(camera, pixel_uv(camera, pixel), texelFetch(surface_depth, pixel, 0).r);
  vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  float basis[COEFFICIENTS];
  probe_basis(n, basis);
#if WITHOUT
  take_out(pixel, basis);
#endif
  return probe_irradiance(grid, x, n_g, basis);
}

#include "lib/resolution.glsl"
