// E(x) = Σ L ∫ V ⟨n,ω⟩₊ dω over emissive triangles, and over the sky.
#define EMITTERS_none 0
#define EMITTERS_few 1
#define EMITTERS_many 2
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/polygon.glsl"
#include "lib/sampling.glsl"
#if EMITTERS != EMITTERS_none
#include "lib/scene_emitters.glsl"
#endif
// The bound on position errors is needed without rays too: no triangle lights what lies in its own plane.
#include "lib/trace.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform int samples;
layout(rgba32f) writeonly uniform image2D irradiance_irradiance;

struct Receiver {
  vec3 x, n, n_g;  // position, shading and geometric normal
  float depth;     // distance over which x was computed
  uint seed;
};

// A seed of its own for each decision of a pixel.
uint stream(Receiver r, uint i) { return hash(uvec4(r.seed, i, 0u, 0u)).x; }

// Sub-pixel samples of one pixel continue one sequence.
uint sample_index(int k, int count) { return frame.random.z * uint(count) + uint(k); }

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

#if EMITTERS == EMITTERS_few
vec3 from_emitters(Receiver r) {
  vec3 sum = vec3(0);
  int count = emitters.length();
  int rays = max(4, (samples + count - 1) / count);
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
      vec2 w = uniform_triangle(low_discrepancy(sample_index(k, rays), stream(r, uint(t))));
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
  return sum;
}
#elif EMITTERS == EMITTERS_many
vec3 from_emitters(Receiver r) {
  vec3 sum = vec3(0);
  for (int k = 0; k < samples; ++k) {
    float probability;
    int t = choose_emitter(low_discrepancy(sample_index(k, samples), stream(r, 0u)).x, probability);
    vec3 a = emitters[t].a.xyz, b = emitters[t].b.xyz, c = emitters[t].c.xyz;
    vec3 side = lit_side(a, b, c, emitters[t].b.w > .5, r);
    if (side == vec3(0) || probability <= 0.) continue;
    vec2 w = uniform_triangle(low_discrepancy(sample_index(k, samples), stream(r, 1u)));
    vec3 p = (1. - w.x - w.y) * a + w.x * b + w.y * c;
    vec3 d = p - r.x;
    float square = dot(d, d);
    float geometry = max(0., dot(r.n, d)) * max(0., -dot(side, d)) / max(square * square, 1e-37);
    if (geometry <= 0. || !visible(r, p, side)) continue;
    sum += emitters[t].radiance.rgb * (geometry * emitters[t].a.w / probability);
  }
  return sum / float(samples);
}
#endif

vec3 from_sky(Receiver r) {
#if TRACED
  int escaped = 0;
  vec3 origin = offset_origin(r.x, r.n_g, r.depth);
  for (int k = 0; k < samples; ++k) {
    vec3 w = cosine_hemisphere(low_discrepancy(sample_index(k, samples), stream(r, 0x736b79u)), r.n);
    if (dot(w, r.n_g) > 0. && !occluded(origin, w, 1e30)) ++escaped;
  }
  return pi * frame.sky.rgb * (float(escaped) / float(samples));
#else
  return pi * frame.sky.rgb;
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 irradiance = vec3(0);
  if (depth > 0.) {
    Receiver r;
    r.x = surface_position(camera, pixel_uv(camera, pixel), depth);
    r.n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    r.n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    r.depth = depth;
    r.seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x61726561u);
#if EMITTERS != EMITTERS_none
    irradiance += from_emitters(r);
#endif
#if SKY
    irradiance += from_sky(r);
#endif
  }
  imageStore(irradiance_irradiance, pixel, vec4(irradiance, 1));
}
