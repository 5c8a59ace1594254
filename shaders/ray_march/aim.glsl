// Rays aimed at what shines most, beside cosine-distributed ones: a side of a sheet is chosen with its share of all power,
// a point on it with equal density. A direction that meets side i at t (in cells) is then chosen with density
//   p_i = L̄·c/W · t²/|⟨n_i,ω⟩|   (L̄ luminance, c coverage, W all power),
// and one that comes from both kinds of rays counts once by the balance heuristic (Veach and Guibas, "Optimally Combining
// Sampling Techniques for Monte Carlo Rendering", 1995): of N and M rays, w_i = N·p / (N·p + M·p_i), p = cosθ/π. An aimed
// ray takes back light of the side alone that it was aimed at, so that each side is a problem of its own.
#ifndef LOOM_RAY_MARCH_AIM_GLSL
#define LOOM_RAY_MARCH_AIM_GLSL
#include "ray_march/power.glsl"

uniform int aimed;
// Sides drawn for this frame, of which every pixel takes some, and W.
layout(std430) readonly buffer scratch_targets {
  float total_power;
  int target_count;
  ivec4 targets[];
};

// The ray under way.
float ray_density = 0.;             // p, of its direction among the cosine-distributed ones
ivec4 target = ivec4(0, 0, 0, -1);  // cell and slab that it is aimed at; w = −1: at nothing

vec3 light_of_crossing(ivec3 cell, int slab, float coverage, float t, float facing) {
  if (target.w >= 0 && target != ivec4(cell, slab)) return vec3(0);
  vec3 radiance = exitant_radiance(cell + ivec3(0, 0, slab * grid.cells.z));
  if (radiance == vec3(0)) return radiance;
  float aimed_density = luminance(radiance) * coverage / total_power * t * t / max(facing, 1e-6);
  float by_cosine = float(samples_of_part(rays)) * ray_density;
  return radiance * (by_cosine / max(by_cosine + float(samples_of_part(aimed)) * aimed_density, 1e-30));
}

// A point of the side, in cells.
vec3 point_on(ivec4 side, vec2 u) {
  int axis = side.w >> 1;
  vec4 plane = texelFetch(voxels_plane, side.xyz + ivec3(0, 0, axis * grid.cells.z), 0);
  vec3 n = turn_axis_last(normalize(plane.xyz), axis);
  vec4 extent = met_extent(side.xyz, axis);
  vec2 at = mix(extent.xy, extent.zw, u) - .5;
  return vec3(side.xyz) + .5 + turn_axis_back(vec3(at, (plane.w - dot(n.xy, at)) / n.z), axis);
}
#endif
