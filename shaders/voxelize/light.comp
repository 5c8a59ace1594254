// Light that every side of every sheet reflects after it came straight from lights, emitters and sky:
// L = ρ/π·(E_direct + E_emitter). One side of a sheet a thread.
#include "interop/frame.h"
#include "voxelize/channels.glsl"
layout(LIGHT_FORMAT) uniform image3D voxels_radiance;  // the albedo at first
#define SHEET_ALBEDO(texel) vec4(from_channels(imageLoad(voxels_radiance, texel)), 0)
#include "lib/rsm.glsl"
#include "lib/sampling.glsl"
#include "lib/scene_lights.glsl"
#include "lib/sheets.glsl"
#include "lib/sky.glsl"
#if SHADOW_MAPS
#include "lib/light_shadow.glsl"
#endif
#if EMITTERS
#include "lib/scene_emitters.glsl"
#endif
layout(local_size_x = 32) in;
layout(std140) uniform frame_data { FrameData frame; };
uniform int rays;

#if PUNCTUAL
// Mean over LIGHT_POINTS² points of the sheet, since the edge of a light or of a shadow may cross it.
const int LIGHT_POINTS = 4;
vec3 from_lights(SheetSide s) {
  vec3 sum = vec3(0);
  for (int i = 0; i < lights.length(); ++i) {
    for (int k = 0; k < LIGHT_POINTS * LIGHT_POINTS; ++k) {
      vec2 at = (vec2(k % LIGHT_POINTS, k / LIGHT_POINTS) + .5) / float(LIGHT_POINTS);
      // Off the plane by what a surface bends within a cell of a tenth of its radius.
      vec3 x = s.corner + at.x * s.across + at.y * s.up + .1 * grid.cascade[0].w * s.normal, l;
      vec3 arriving = light_irradiance(lights[i], x, l);
      float cosine = dot(s.normal, l);
      if (cosine <= 0. || arriving == vec3(0)) continue;
#if SHADOW_MAPS
      float visible = light_visibility(lights[i], x, s.normal, false);
#else
      bool directional = int(lights[i].position.w) == LIGHT_DIRECTIONAL;
      float reach = directional ? 1e30 : distance(lights[i].position.xyz, x);
      float visible = march(x, l, s.normal, reach).transmittance;
#endif
      sum += arriving * cosine * visible;
    }
  }
  return sum / float(LIGHT_POINTS * LIGHT_POINTS);
}
#endif

#if EMITTERS
// E = 1/N Σ L cosθ cosθ'/(r² p) V over points chosen by emitted power.
vec3 from_emitters(SheetSide s, uint seed) {
  vec3 sum = vec3(0);
  for (int k = 0; k < rays; ++k) {
    float probability;
    int t = choose_emitter(low_discrepancy(uint(k), hash(uvec4(seed, 1u, 0u, 0u)).x).x, probability);
    vec3 a = emitters[t].a.xyz, b = emitters[t].b.xyz, c = emitters[t].c.xyz;
    vec2 w = uniform_triangle(low_discrepancy(uint(k), hash(uvec4(seed, 2u, 0u, 0u)).x));
    vec3 d = (1. - w.x - w.y) * a + w.x * b + w.y * c - s.position;
    vec3 n = normalize_or(cross(b - a, c - a), vec3(0));
    float facing = -dot(n, d), square = dot(d, d);
    if (emitters[t].b.w > .5) facing = abs(facing);
    float geometry = max(0., dot(s.normal, d)) * max(0., facing) / max(square * square, 1e-37);
    if (geometry <= 0. || probability <= 0.) continue;
    // The emitter's own sheet lies at the end of the way: half a cell of it is free.
    float reach = sqrt(square);
    float visible = march(s.position, d / reach, s.normal, reach - .5 * grid.cascade[0].w).transmittance;
    sum += emitters[t].radiance.rgb * (visible * geometry * emitters[t].a.w / probability);
  }
  return sum / float(rays);
}
#endif

#if SKY
vec3 from_sky(SheetSide s, uint seed) {
  vec3 escaped = vec3(0);
  for (int k = 0; k < rays; ++k) {
    vec3 w = cosine_hemisphere(low_discrepancy(uint(k), hash(uvec4(seed, 3u, 0u, 0u)).x), s.normal);
    float free = march(s.position, w, s.normal, 1e30).transmittance;
#if SCENE_SKY_IMAGE
    escaped += free * sky_radiance(frame.sky, w, 2. * pi / float(rays));
#else
    escaped += vec3(free);
#endif
  }
#if SCENE_SKY_IMAGE
  return pi * (escaped / float(rays));
#else
  return pi * frame.sky.rgb * (escaped / float(rays));
#endif
}
#endif

void main() {
  ivec3 id = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(id, grid.cells.xyz * ivec3(1, 1, 6)))) return;
  int slab = id.z / grid.cells.z;
  ivec3 cell = ivec3(id.xy, id.z - slab * grid.cells.z);
  SheetSide s;
  vec3 radiance = vec3(0);
  if (sheet_side(cell, slab >> 1, slab & 1, s) && s.albedo != vec3(0)) {
    uint seed = hash(uvec4(uvec3(s.texel), frame.random.x)).x;
    vec3 irradiance = vec3(0);
#if PUNCTUAL
    irradiance += from_lights(s);
#endif
#if EMITTERS
    irradiance += from_emitters(s, seed);
#endif
#if SKY
    irradiance += from_sky(s, seed);
#endif
    radiance = s.albedo * irradiance * inverse_pi;
  }
  imageStore(voxels_radiance, s.texel, stored(in_channels(radiance, 1.)));
}
