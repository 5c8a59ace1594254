// Light paths: what each surface on the way reflects. Slot path·order_count + k holds light k of a path; those that there
// are not have the order 0.
#include "interop/frame.h"
#include "interop/vpl.h"
#include "instant_radiosity/start.glsl"
#include "lib/trace.glsl"
layout(local_size_x = 64) in;
layout(std430) restrict buffer persistent_slots { Vpl slots[]; };
uniform int order_count;

bool same_place(Vpl a, Vpl b) { return a.position == b.position && a.normal.xyz == b.normal.xyz; }

// Stores light k and says whether the last frame had it there.
void put(int slot, Vpl light) {
  Vpl last = slots[slot];
  light.flux.w = same_place(light, last) ? 1. : 0.;
  slots[slot] = light;
}

// Follows a path. `held`: through the places of the last frame; false where one of them is no longer met.
bool follow(int path, Start start, Ray ray, bool held) {
  int first = path * order_count, k = 0;
  for (; k < order_count; ++k) {
    Hit hit = closest_hit(ray.origin, ray.direction, no_hit);
    if (!is_hit(hit)) break;
    vec3 position = hit_position(hit), n = hit_normal(hit), albedo = hit_albedo(hit);
    if (dot(n, ray.direction) > 0.) n = -n;
    if (held && k < ray.held_until) {
      // Rounding of the way there, and of a surface that stands still.
      vec3 stored = slots[first + k].position.xyz;
      if (distance(stored, position) > 1e-4 * hit.t || dot(n, slots[first + k].normal.xyz) < .999) return false;
      position = stored;
      n = slots[first + k].normal.xyz;
    }
    ray.flux *= albedo;
    if (ray.flux == vec3(0)) break;
    put(first + k, Vpl(vec4(position, k + 1), vec4(n, path), vec4(ray.flux, 0)));
    uint seeds = dimension(start, 4u + 2u * uint(k));
#if ROULETTE
    float survival = min(1., max(albedo.r, max(albedo.g, albedo.b)));
    if (low_discrepancy(uint(start.index), seeds).x >= survival) {
      ++k;
      break;
    }
    ray.flux /= survival;
#endif
    ray.origin = offset_origin(position, n, hit.t);
    bool known = held && k + 1 < ray.held_until;
    ray.direction = known ? normalize_or(slots[first + k + 1].position.xyz - ray.origin, n)
                          : cosine_hemisphere(low_discrepancy(uint(start.index), seeds ^ 0x9e3779b9u), n);
  }
  for (; k < order_count; ++k) put(first + k, Vpl(vec4(0), vec4(0, 1, 0, path), vec4(0)));
  return true;
}

void main() {
  int path = int(gl_GlobalInvocationID.x);
  if (path >= starts.length() || (path + 1) * order_count > slots.length()) return;
  Start start = start_of(path);
  Ray ray;
#if KEEP
  int held_until = 0;
  while (held_until < order_count && slots[path * order_count + held_until].position.w > 0.) ++held_until;
  if (held_until > 0 && ray_to(start, slots[path * order_count].position.xyz, ray)) {
    ray.held_until = held_until;
    if (follow(path, start, ray, true)) return;
  }
#endif
  ray = first_ray(start);
  follow(path, start, ray, false);
}
