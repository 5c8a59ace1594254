// Irradiance straight from emissive triangles and the sky, with visibility by rays.
// The including file defines EMITTERS (EMITTERS_none, _few, _many), TRACED (0: nothing blocks) and, where the scene has
// masked materials, SCENE_ALPHA_MASK. See passes/area_light/area_light.cpp for the estimators.
#ifndef LOOM_LIB_AREA_LIGHT_GLSL
#define LOOM_LIB_AREA_LIGHT_GLSL
#define EMITTERS_none 0
#define EMITTERS_few 1
#define EMITTERS_many 2
#include "lib/polygon.glsl"
#include "lib/sampling.glsl"
#include "lib/sky.glsl"
#if EMITTERS != EMITTERS_none
#include "lib/scene_emitters.glsl"
#endif
// The bound on position errors is needed without rays too: no triangle lights what lies in its own plane.
#include "lib/trace.glsl"

struct Receiver {
  vec3 x, n, n_g;  // position, shading and geometric normal
  float depth;     // distance over which x was computed
  uint seed;
  uint sequence;   // sub-pixel samples of one receiver continue one sequence
};

// A seed of its own for each decision of a receiver.
uint stream(Receiver r, uint i) { return hash(uvec4(r.seed, i, 0u, 0u)).x; }

uint sample_index(Receiver r, int k, int count) { return r.sequence * uint(count) + uint(k); }

// The side of a triangle that r.x lies on: its unit normal towards x, or 0 where it gives x nothing (its back, or its
// own plane, within the rounding of x).
vec3 lit_side(vec3 a, vec3 b, vec3 c, bool both_sides, Receiver r) {
  vec3 n = normalize_or(cross(b - a, c - a), vec3(0));
  float height = dot(n, r.x - a);
  vec3 m = max(abs(r.x), abs(a));
  if (abs(height) <= position_error * (max(m.x, max(m.y, m.z)) + r.depth)) return vec3(0);
  return height > 0. ? n : both_sides ? -n : vec3(0);
}

bool visible(Receiver r, vec3 point, vec3 point_normal) {
#if TRACED
  return dot(r.n_g, point - r.x) > 0. && !segment_occluded(r.x, r.n_g, r.depth, point, point_normal, 0.);
#else
  return true;
#endif
}

// `samples` rays in all, at least `least` a triangle where each is integrated.
vec3 emitter_irradiance(Receiver r, int samples, int least) {
  vec3 sum = vec3(0);
#if EMITTERS == EMITTERS_few
  int count = emitters.length();
  int rays = max(least, (samples + count - 1) / count);
  for (int t = 0; t < count; ++t) {
    vec3 a = emitters[t].a.xyz, b = emitters[t].b.xyz, c = emitters[t].c.xyz;
    vec3 side = lit_side(a, b, c, emitters[t].b.w > .5, r);
    if (side == vec3(0)) continue;
    HorizonPolygon polygon = clip_to_horizon(a - r.x, b - r.x, c - r.x, r.n);
    float unblocked = polygon_irradiance(polygon, r.n);
    if (unblocked <= 0.) continue;
    float share = 1.;
#if TRACED
    float weights = 0., seen = 0.;
    for (int k = 0; k < rays; ++k) {
      vec2 w = uniform_triangle(low_discrepancy(sample_index(r, k, rays), stream(r, uint(t))));
      vec3 p = (1. - w.x - w.y) * a + w.x * b + w.y * c;
      vec3 d = p - r.x;
      float square = dot(d, d);
      float weight = max(0., dot(r.n, d)) * max(0., -dot(side, d)) / max(square * square, 1e-37);
      if (weight <= 0.) continue;
      weights += weight;
      if (visible(r, p, side)) seen += weight;
    }
    // All points below the horizon while a corner stands above it: ask that corner.
    share = weights > 0. ? seen / weights : visible(r, r.x + polygon_middle(polygon), side) ? 1. : 0.;
#endif
    sum += emitters[t].radiance.rgb * (unblocked * share);
  }
#elif EMITTERS == EMITTERS_many
  for (int k = 0; k < samples; ++k) {
    float probability;
    int t = choose_emitter(low_discrepancy(sample_index(r, k, samples), stream(r, 0u)).x, probability);
    vec3 a = emitters[t].a.xyz, b = emitters[t].b.xyz, c = emitters[t].c.xyz;
    vec3 side = lit_side(a, b, c, emitters[t].b.w > .5, r);
    if (side == vec3(0) || probability <= 0.) continue;
    vec2 w = uniform_triangle(low_discrepancy(sample_index(r, k, samples), stream(r, 1u)));
    vec3 p = (1. - w.x - w.y) * a + w.x * b + w.y * c;
    vec3 d = p - r.x;
    float square = dot(d, d);
    float geometry = max(0., dot(r.n, d)) * max(0., -dot(side, d)) / max(square * square, 1e-37);
    if (geometry <= 0. || !visible(r, p, side)) continue;
    sum += emitters[t].radiance.rgb * (geometry * emitters[t].a.w / probability);
  }
  sum /= float(samples);
#endif
  return sum;
}

// `sky`: FrameData.sky. `rays`: that the receiver gets in all, of which these are `samples`.
vec3 sky_irradiance(Receiver r, vec4 sky, int samples, float rays) {
#if SCENE_SKY_IMAGE
  vec3 sum = vec3(0), origin = offset_origin(r.x, r.n_g, r.depth);
  for (int k = 0; k < samples; ++k) {
    vec3 w = cosine_hemisphere(low_discrepancy(sample_index(r, k, samples), stream(r, 0x736b79u)), r.n);
    if (dot(w, r.n_g) <= 0.) continue;
#if TRACED
    if (occluded(origin, w, 1e30)) continue;
#endif
    sum += sky_radiance(sky, w, 2. * pi / rays);
  }
  return sum * (pi / float(samples));
#elif TRACED
  int escaped = 0;
  vec3 origin = offset_origin(r.x, r.n_g, r.depth);
  for (int k = 0; k < samples; ++k) {
    vec3 w = cosine_hemisphere(low_discrepancy(sample_index(r, k, samples), stream(r, 0x736b79u)), r.n);
    if (dot(w, r.n_g) > 0. && !occluded(origin, w, 1e30)) ++escaped;
  }
  return pi * sky.rgb * (float(escaped) / float(samples));
#else
  return pi * sky.rgb;
#endif
}
#endif
