// Irradiance of a surface from the intensity volume: L(−ω) = 2·I(ω)/(3s²), E(n) = ∫ L·cos.
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/grid.glsl"
#include "lib/sh.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform volume_data { Grid grid; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler3D volume_red;
uniform sampler3D volume_green;
uniform sampler3D volume_blue;
layout(rgba32f) uniform writeonly image2D irradiance_irradiance;

// Irradiance on a surface that faces −axis, from light that travels with radiance coefficients c.
float irradiance(vec4 c, vec3 axis) {
#if NON_NEGATIVE
  // Two bands of a strongly directional field ring below zero; this form keeps total and mean direction and is never
  // negative (energy E0, directionality r, power p).
  if (c.x <= 0.0) return 0.0;
  vec3 c1 = c.wyz;
  float length1 = length(c1), e0 = 0.88622693 * c.x;
  float r = min(1.0, length1 / (1.7320508 * c.x));
  float q = length1 > 0.0 ? 0.5 * (1.0 + dot(c1 / length1, axis)) : 0.5;
  float p = 1.0 + 2.0 * r, a = (1.0 - r) / (1.0 + r);
  return e0 * (a + (1.0 - a) * (p + 1.0) * pow(max(q, 0.0), p));
#else
  return max(0.0, dot(c, sh2_cosine_lobe(axis)));
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 e = vec3(0);
  if (depth > 0.0) {
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec3 position = surface_position(camera, (vec2(pixel) + 0.5) * camera.size.zw, depth);
    float s = grid.cascade[0].w;
    // Half a cell off the surface: the surface's own cell holds light of both of its sides.
    vec3 at = grid_coordinates(grid, 0, position + 0.5 * s * n) / vec3(grid.cells.xyz);
    float to_radiance = 2.0 / (3.0 * s * s);
    e = to_radiance * vec3(irradiance(texture(volume_red, at), -n), irradiance(texture(volume_green, at), -n),
                           irradiance(texture(volume_blue, at), -n));
  }
  imageStore(irradiance_irradiance, pixel, vec4(e, 1.0));
}
