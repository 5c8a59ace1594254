// Irradiance at each pixel from the eight probes around it.
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/math.glsl"
#include "lib/probes.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform field_data { ProbeGrid grid; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler2DArray field_coefficients;
uniform sampler2DArray field_moments;
uniform sampler3D field_state;
writeonly uniform image2D irradiance_irradiance;

vec4 probe_state(ivec3 probe) { return texelFetch(field_state, probe, 0); }
vec2 probe_moments(ivec3 probe, ivec2 texel) {
  return texelFetch(field_moments, ivec3(probe.xy * moments_size(grid) + texel, probe.z), 0).rg;
}
vec3 probe_coefficient(ivec3 probe, int i) {
  return texelFetch(field_coefficients, ivec3(probe.x * COEFFICIENTS + i, probe.yz), 0).rgb;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 e = vec3(0);
  if (depth > 0.) {
    vec3 x = surface_position(camera, pixel_uv(camera, pixel), depth);
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    e = probe_irradiance(grid, x, n, n_g);
  }
  imageStore(irradiance_irradiance, pixel, vec4(e, 1));
}
