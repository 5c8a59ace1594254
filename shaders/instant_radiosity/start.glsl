// Where a light path begins, and with which flux (passes/instant_radiosity/instant_radiosity.cpp has the equations).
#include "lib/rsm.glsl"
#include "lib/sampling.glsl"
#if PUNCTUAL
#include "lib/scene_lights.glsl"
#endif
#if EMITTERS
#include "lib/scene_emitters.glsl"
#endif
#include "lib/sky.glsl"
#include "lib/trace.glsl"

layout(std140) uniform frame_data { FrameData frame; };
layout(std430) readonly restrict buffer scratch_starts { ivec4 starts[]; };
uniform uint sequence;
uniform vec3 box_low;  // of the scene
uniform vec3 box_high;

#define SOURCE_EMITTERS -1
#define SOURCE_SKY -2

struct Start {
  int source;    // a punctual light, or SOURCE_*
  int index;     // of the path among those of the source
  int count;     // of them
  float weight;  // 1/(N·p)
};

struct Ray {
  vec3 origin, direction, flux;
  int held_until;  // places of the last frame that it goes through
};

Start start_of(int path) { return Start(starts[path].x, starts[path].y, starts[path].z, intBitsToFloat(starts[path].w)); }

// A seed for each pair of numbers that a path of the source takes.
uint dimension(Start start, uint i) { return hash(uvec4(sequence, uint(start.source + 2), i, 0x76706cu)).x; }
vec2 numbers(Start start, uint i) { return low_discrepancy(uint(start.index), dimension(start, i)); }

// The rectangle across `direction` that the scene's box stays within.
struct Across {
  mat3 basis;  // columns: two sides, and the direction
  vec3 middle;
  vec3 half_size;
};

Across across(vec3 direction) {
  Across a;
  a.basis = orthonormal_basis(direction);
  a.middle = .5 * (box_low + box_high);
  vec3 h = .5 * (box_high - box_low);
  // What is flat as seen from there still has a rectangle.
  float least = 1e-4 * max(h.x, max(h.y, h.z));
  for (int i = 0; i < 3; ++i) a.half_size[i] = max(dot(abs(a.basis[i]), h), least);
  return a;
}

Ray ray_across(Across a, vec2 u, vec3 flux_density) {
  vec3 at = vec3(2. * u - 1., -1.01) * a.half_size;
  return Ray(a.middle + a.basis * at, a.basis[2], flux_density * (4. * a.half_size.x * a.half_size.y), 0);
}

#if PUNCTUAL
float solid_angle(Light light) { return int(light.position.w) == LIGHT_SPOT ? 2. * pi * (1. - light.cone.x) : 4. * pi; }

Ray ray_along(Light light, vec3 w, float weight) {
  return Ray(light.position.xyz, w, light_intensity(light, w) * (solid_angle(light) * weight), 0);
}

Ray light_ray(Light light, vec2 u, float weight) {
  if (int(light.position.w) == LIGHT_DIRECTIONAL) {
    return ray_across(across(light.direction.xyz), u, light.intensity.rgb * weight);
  }
  vec3 w = uniform_sphere(u);
  if (int(light.position.w) == LIGHT_SPOT) {
    float z = mix(1., light.cone.x, u.x), r = sqrt(max(0., 1. - z * z)), angle = 2. * pi * u.y;
    w = orthonormal_basis(light.direction.xyz) * vec3(r * cos(angle), r * sin(angle), z);
  }
  return ray_along(light, w, weight);
}

// The numbers u for which light_ray() goes to a point.
vec2 numbers_to(Light light, vec3 point) {
  if (int(light.position.w) == LIGHT_DIRECTIONAL) {
    Across a = across(light.direction.xyz);
    vec3 d = point - a.middle;
    return .5 + .5 * vec2(dot(d, a.basis[0]) / a.half_size.x, dot(d, a.basis[1]) / a.half_size.y);
  }
  vec3 w = normalize_or(point - light.position.xyz, vec3(0, 0, 1));
  float share = .5 * (1. - w.z);
  if (int(light.position.w) == LIGHT_SPOT) {
    w = transpose(orthonormal_basis(light.direction.xyz)) * w;
    share = (1. - w.z) / max(1. - light.cone.x, 1e-12);
  }
  return vec2(share, fract(atan(w.y, w.x) / (2. * pi) + 1.));
}

// The stratum of a source's 2ᵏ paths: points of a (0,k,2)-net lie one in each box of these sides.
ivec2 stratum(vec2 u, int count) {
  int k = findMSB(max(count, 1));
  return ivec2(floor(u * vec2(1 << ((k + 1) / 2), 1 << (k / 2))));
}

// The ray from the source to a place that the path has had. False where it no longer begins in the path's stratum, and
// from sources whose paths are not known by where they go.
bool ray_to(Start start, vec3 place, out Ray ray) {
  ray = Ray(vec3(0), vec3(0, 1, 0), vec3(0), 0);
  if (start.source < 0) return false;
  Light light = lights[min(start.source, lights.length() - 1)];
  vec2 u = numbers_to(light, place);
  if (stratum(u, start.count) != stratum(numbers(start, 0u), start.count)) return false;
  ray = int(light.position.w) == LIGHT_DIRECTIONAL
            ? light_ray(light, u, start.weight)
            : ray_along(light, normalize_or(place - light.position.xyz, vec3(0, 1, 0)), start.weight);
  return true;
}
#else
bool ray_to(Start start, vec3 place, out Ray ray) {
  ray = Ray(vec3(0), vec3(0, 1, 0), vec3(0), 0);
  return false;
}
#endif

Ray first_ray(Start start) {
  Ray ray = Ray(vec3(0), vec3(0, 1, 0), vec3(0), 0);
#if PUNCTUAL
  if (start.source >= 0) return light_ray(lights[min(start.source, lights.length() - 1)], numbers(start, 0u), start.weight);
#endif
#if EMITTERS
  if (start.source == SOURCE_EMITTERS) {
    float probability;
    vec2 choice = numbers(start, 2u);
    Emitter e = emitters[choose_emitter(choice.x, probability)];
    vec2 at = uniform_triangle(numbers(start, 0u));
    vec3 point = (1. - at.x - at.y) * e.a.xyz + at.x * e.b.xyz + at.y * e.c.xyz;
    vec3 n = normalize_or(cross(e.b.xyz - e.a.xyz, e.c.xyz - e.a.xyz), vec3(0, 1, 0));
    bool both = e.b.w > .5;
    if (both && choice.y < .5) n = -n;
    ray.origin = offset_origin(point, n, 0.);
    ray.direction = cosine_hemisphere(numbers(start, 1u), n);
    if (probability > 0.) ray.flux = e.radiance.rgb * (pi * e.a.w * (both ? 2. : 1.) * start.weight / probability);
    return ray;
  }
#endif
  if (start.source == SOURCE_SKY) {
    vec3 w = uniform_sphere(numbers(start, 0u));
    vec3 radiance = sky_radiance(frame.sky, -w, 4. * pi / float(max(start.count, 1)));
    ray = ray_across(across(w), numbers(start, 1u), radiance * (4. * pi * start.weight));
  }
  return ray;
}
