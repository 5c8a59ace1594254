// What the bound took away, by short rays: E(x) += π/R·Σ ρ/π·E(y)·(G(x,y) − b)₊/G(x,y).
#include "lib/area_light.glsl"
#include "lib/rsm.glsl"
#if PUNCTUAL
#include "lib/scene_lights.glsl"
#endif
uniform int compensation;
uniform int compensation_lights;

Receiver receiver_of(Point p, uint seed) { return Receiver(p.x, p.n, p.n_g, p.extent, seed, 0u); }

// Straight light of all kinds, W/m².
vec3 straight_irradiance(Point p, uint seed) {
  vec3 e = vec3(0);
#if PUNCTUAL
  vec3 origin = offset_origin(p.x, p.n_g, p.extent);
  for (int i = 0; i < lights.length(); ++i) {
    vec3 l;
    vec3 arriving = light_irradiance(lights[i], p.x, l) * max(0., dot(p.n, l));
    if (arriving == vec3(0)) continue;
    bool directional = int(lights[i].position.w) == LIGHT_DIRECTIONAL;
    float reach = directional ? no_hit : distance(lights[i].position.xyz, origin);
    if (!occluded(origin, l, reach)) e += arriving;
  }
#endif
#if EMITTERS != EMITTERS_none
  e += emitter_irradiance(receiver_of(p, seed), 1, 1);
#endif
#if SKY
  e += sky_irradiance(receiver_of(p, seed), frame.sky, 1, float(compensation));
#endif
  return e;
}

vec3 compensate(Point x, float b, uint seed) {
  vec3 sum = vec3(0);
  uint count = vpl_count();
  // G > b needs r² < 1/b.
  float reach = inversesqrt(b);
  // The rays of this dispatch.
  int share = (compensation + dispatches - 1) / dispatches, end = min((index + 1) * share, compensation);
  for (int k = index * share; k < end; ++k) {
    uint number = frame.random.z * uint(compensation) + uint(k);
    Point p = x;
    vec3 weight = vec3(1);
    for (uint depth = 0u; depth < uint(DEPTH); ++depth) {
      uvec4 seeds = hash(uvec4(seed, depth, 0u, 0u));
      vec3 w = cosine_hemisphere(low_discrepancy(number, seeds.x), p.n);
      if (dot(w, p.n_g) <= 0.) break;
      Hit hit = closest_hit(offset_origin(p.x, p.n_g, p.extent), w, reach);
      if (!is_hit(hit)) break;
      Point y = Point(hit_position(hit), hit_normal(hit), vec3(0), p.extent + hit.t);
      if (dot(y.n, w) > 0.) y.n = -y.n;
      y.n_g = y.n;
      float g = geometry_term(p, y.x, y.n);
      if (g <= b) break;
      weight *= hit_albedo(hit) * (1. - b / g);
      vec3 e = straight_irradiance(y, seeds.y ^ number), taken;
      // Lights from a random place on, as many as there are to take: each with the same chance.
      uint some = min(uint(compensation_lights), count);
      uint from = uint(low_discrepancy(number, seeds.z).x * float(count));
      for (uint j = 0u; j < some; ++j) {
        uint light = (from + j * max(1u, count / some)) % count;
        vec3 given;
        gather(y, light, light + 1u, b, given, taken);
        e += given * (float(count) / float(some));
      }
      sum += weight * e;
      p = y;
    }
  }
  return sum / float(compensation);
}
