// Irradiance at the visible surface: cosine-distributed rays through the voxels, E = π/N · Σ L, and rays aimed at what
// shines most.
#include "interop/camera.h"
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/sampling.glsl"
#include "lib/exitant_sheets.glsl"
#include "lib/sky.glsl"
uniform int rays;
#include "lib/parts.glsl"
#if AIMED
vec3 light_of_crossing(ivec3 cell, int slab, float coverage, float t, float facing);
#define SHEET_LIGHT(cell, slab, coverage, t, facing) light_of_crossing(cell, slab, coverage, t, facing)
#endif
// After what sheets send out is known.
#include "lib/voxels.glsl"
#if AIMED
#include "ray_march/aim.glsl"
#endif

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;

struct Point {
  vec3 position, normal, geometric_normal;
  uint seed;
};

// Σ L over the cosine-distributed rays.
vec3 gather(Point x) {
  vec3 sum = vec3(0);
  int count = samples_of_part(rays);
  for (int k = 0; k < count; ++k) {
    uint i = stretch_of_part(frame.random.z) * uint(count) + uint(k);
    vec3 w = cosine_hemisphere(low_discrepancy(i, x.seed), x.normal);
    if (dot(w, x.geometric_normal) <= 0.) continue;
#if AIMED
    ray_density = dot(w, x.normal) * inverse_pi;
#endif
    March ray = march(x.position, w, x.geometric_normal, 1e30);
    sum += ray.radiance;
#if EMITTER
    sum += ray.transmittance * sky_radiance(frame.sky, w, 2. * pi / (float(rays) * float(frame.random.w)));
#endif
  }
  return sum;
}

#if AIMED
// The same over the aimed rays, weighted to the same scale.
vec3 aim(Point x) {
  vec3 origin = grid_coordinates(grid, 0, x.position), sum = vec3(0);
  uint seeds[2] = uint[2](hash(uvec4(x.seed, 1u, 0u, 0u)).x, hash(uvec4(x.seed, 2u, 0u, 0u)).x);
  int count = samples_of_part(aimed);
  for (int k = 0; k < count; ++k) {
    uint i = stretch_of_part(frame.random.z) * uint(count) + uint(k);
    target = targets[min(int(low_discrepancy(i, seeds[0]).x * float(target_count)), target_count - 1)];
    if (target.w < 0) continue;
    vec3 d = point_on(target, low_discrepancy(i, seeds[1])) - origin;
    float t = length(d);
    vec3 w = d / max(t, 1e-6);
    ray_density = dot(w, x.normal) * inverse_pi;
    if (ray_density <= 0. || dot(w, x.geometric_normal) <= 0.) continue;
    sum += march(x.position, w, x.geometric_normal, (t + 2. * SEAM) * grid.cascade[0].w).radiance;
  }
  target.w = -1;
  return sum;
}
#endif

vec3 irradiance_at(ivec2 pixel) {
  Point x;
  x.position = surface_position(camera, pixel_uv(camera, pixel), texelFetch(surface_depth, pixel, 0).r);
  x.normal = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  x.geometric_normal = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  x.seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x6d617263u);
  vec3 sum = vec3(0);
#if AIMED
  if (total_power > 0.) sum += aim(x);
#endif
  sum += gather(x);
  return sum * (pi / float(samples_of_part(rays)));
}

#include "lib/resolution.glsl"
