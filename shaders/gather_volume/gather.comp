// Irradiance of a surface from the intensity volume: L(−ω) = 2·I(ω)/(3s²), E(n) = ∫ L·cos.
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/grid.glsl"
#include "lib/sh.glsl"

layout(std140) uniform surface_data { Camera camera; };
layout(std140) uniform volume_data { Grid grid; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler3D volume_red;
#if CHANNELS > 1
uniform sampler3D volume_green;
uniform sampler3D volume_blue;
#endif
uniform float blend;

#if WITHOUT
uniform sampler2DArray without_image;
#endif

// Irradiance on a surface that faces −axis, from light that travels with radiance coefficients c; `lobe`: the clamped
// cosine about axis, less what a near field has answered for.
float irradiance(vec4 c, vec3 axis, vec4 lobe) {
#if NON_NEGATIVE && !WITHOUT
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
  return max(0.0, dot(c, lobe));
#endif
}

// What cascade k says of the surface at a position; the volume is read half a cell off it, since the surface's own cell
// holds light of both of its sides. `share`: 1 inside, falling to 0 over `blend` cells at the border.
vec3 from_cascade(int k, vec3 position, vec3 n, vec4 lobe, out float share) {
  float s = grid.cascade[k].w;
  vec3 cells = vec3(grid.cells.xyz);
  vec3 at = grid_coordinates(grid, k, position + 0.5 * s * n);
  // Beyond the centres of the outermost cells there is nothing to interpolate with, and along z another cascade follows.
  vec3 inside = min(at, cells - at) - 0.5;
  share = clamp(min(inside.x, min(inside.y, inside.z)) / max(blend, 1e-6), 0.0, 1.0);
  at = clamp(at, vec3(0.5), cells - 0.5);
  vec3 uvw = (at + vec3(0, 0, k * grid.cells.z)) / vec3(grid.cells.xy, grid.cells.z * grid.cells.w);
  vec3 e = vec3(irradiance(texture(volume_red, uvw), -n, lobe));
#if CHANNELS > 1
  e.g = irradiance(texture(volume_green, uvw), -n, lobe);
  e.b = irradiance(texture(volume_blue, uvw), -n, lobe);
#endif
  return 2.0 / (3.0 * s * s) * e;
}

vec3 irradiance_at(ivec2 pixel) {
  vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz), e = vec3(0);
  vec3 position =
      surface_position(camera, (vec2(pixel) + 0.5) * camera.size.zw, texelFetch(surface_depth, pixel, 0).r);
  vec4 lobe = sh2_cosine_lobe(-n);
#if WITHOUT
  // Light travels against the directions in which rays went: odd bands change their sign.
  lobe -= vec4(1, -1, -1, -1) * texelFetch(without_image, ivec3(pixel, 0), 0);
#endif
  float left = 1.0;  // share that finer cascades have not answered for
  int cascades = clamp(grid.cells.w, 1, LOOM_MAX_CASCADES);
  for (int k = 0; k < cascades && left > 0.0; ++k) {
    float share;
    vec3 of_this = from_cascade(k, position, n, lobe, share);
    if (k == cascades - 1) share = 1.0;  // the coarsest answers for the rest
    e += left * share * of_this;
    left *= 1.0 - share;
  }
  return e;
}

#include "lib/resolution.glsl"
