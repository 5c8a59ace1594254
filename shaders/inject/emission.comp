// Traces light of emitters and of the sky to the surface that it first meets. What that reflects is injected; the way
// there is AreaLight's, so that no light is counted twice.
//   emitter: a point chosen by power p, a direction by cosine:       Φ_ray = π·L·sides·A/(p·N)
//   sky:     a uniform direction, a point of the disc of radius R
//            about the scene that faces it:                          Φ_ray = 4π·πR²·L/N
// The sequence is the same in every frame: nothing flickers, and a still scene is traced once.
#include "interop/frame.h"
#include "inject/elements.glsl"
#include "inject/hit.glsl"
#include "lib/sampling.glsl"
#include "lib/sky.glsl"
#include "lib/trace.glsl"
#if EMITTERS
#include "lib/scene_emitters.glsl"
#endif
layout(local_size_x = 8) in;

layout(std140) uniform frame_data { FrameData frame; };
layout(std430) writeonly buffer persistent_emission { EmissionHit emission[]; };
uniform int emission_rays;  // of each kind
uniform vec3 scene_centre;
uniform float scene_radius;

#if EMITTERS
EmissionHit from_emitter(int index, vec2 where, vec2 which_way, float choice) {
  float probability;
  int t = choose_emitter(choice, probability);
  vec3 a = emitters[t].a.xyz, b = emitters[t].b.xyz, c = emitters[t].c.xyz;
  vec3 n = normalize_or(cross(b - a, c - a), vec3(0));
  float sides = emitters[t].b.w > 0.5 ? 2. : 1.;
  // Every other ray of an emitter with two sides leaves by its back.
  if (sides > 1.5 && (index & 1) == 1) n = -n;
  vec2 w = uniform_triangle(where);
  vec3 origin = offset_origin((1. - w.x - w.y) * a + w.x * b + w.y * c, n, 0.);
  vec3 direction = cosine_hemisphere(which_way, n);
  EmissionHit none = EmissionHit(vec4(0), vec4(0), vec4(0));
  if (probability <= 0. || n == vec3(0)) return none;
  Hit hit = closest_hit(origin, direction, no_hit);
  if (!is_hit(hit)) return none;
  vec3 flux = emitters[t].radiance.rgb * (pi * sides * emitters[t].a.w / (probability * float(emission_rays)));
  vec3 normal = hit_normal(hit);
  return EmissionHit(vec4(hit_position(hit), 0), vec4(dot(normal, direction) > 0. ? -normal : normal, 1),
                     vec4(flux * hit_albedo(hit), 0));
}
#endif

#if SKY
EmissionHit from_sky(vec2 where, vec2 which_way) {
  vec3 direction = uniform_sphere(which_way);
  float r = sqrt(where.x) * scene_radius, angle = 2. * pi * where.y;
  vec3 origin = scene_centre +
                orthonormal_basis(direction) * vec3(r * cos(angle), r * sin(angle), -1.01 * scene_radius);
  Hit hit = closest_hit(origin, direction, no_hit);
  if (!is_hit(hit)) return EmissionHit(vec4(0), vec4(0), vec4(0));
  vec3 flux = sky_radiance(frame.sky, -direction, 4. * pi / float(emission_rays)) *
              (4. * pi * pi * scene_radius * scene_radius / float(emission_rays));
  vec3 normal = hit_normal(hit);
  return EmissionHit(vec4(hit_position(hit), 0), vec4(dot(normal, direction) > 0. ? -normal : normal, 1),
                     vec4(flux * hit_albedo(hit), 0));
}
#endif

void main() {
  int index = element_index();
  if (index >= emission.length()) return;
  uint ray = uint(index % emission_rays);
  uint kind = uint(index / emission_rays);
  uint seed = frame.random.x;
  vec2 where = low_discrepancy(ray, seed ^ (0x656d6974u + kind));
  vec2 which_way = low_discrepancy(ray, seed ^ (0x77617973u + kind));
#if EMITTERS
  if (kind == 0u) {
    // The choice takes strata in order: every emitter gets its share of the rays.
    float choice = (float(ray) + 0.5) / float(emission_rays);
    emission[index] = from_emitter(index, where, which_way, min(choice, 0.99999994));
    return;
  }
#endif
#if SKY
  emission[index] = from_sky(where, which_way);
#endif
}
