// First reflection at what the probes see: L = ρ/π·(E_punctual + E_emitters + E_sky). What a surface emits itself is left
// out: it reaches the receivers without a bounce.
#include "interop/frame.h"
#include "lib/math.glsl"
#if AREA
#include "lib/area_light.glsl"
#endif
#if PUNCTUAL
#include "lib/punctual_light.glsl"
#endif
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std140) uniform frame_data { FrameData frame; };
uniform int emitter_rays;

void main() {
  int t = int(gl_GlobalInvocationID.x), slot = int(gl_GlobalInvocationID.y);
  if (t >= texel_count() || slot >= slot_count) return;
  int i = slot * texel_count() + t, probe = probe_of(slot);
  float distance = texels[i].distance;
  if (distance == 0. || states[probe].w < .5) return;
  Surfel s = unpack_surfel(surfaces[i]);
  vec3 x = standing_at(probe) + abs(distance) * texel_direction(t), e = vec3(0);
#if PUNCTUAL
  e += punctual_irradiance(x, s.n, s.n_g);
#endif
#if AREA
  Receiver r;
  r.x = x;
  r.n = s.n;
  r.n_g = s.n_g;
  r.depth = abs(distance);
  r.seed = hash(uvec4(t, probe, frame.random.x, 0x70726f62u)).x;
  r.sequence = 0u;
#if EMITTERS != EMITTERS_none
  e += emitter_irradiance(r, emitter_rays, 1);
#endif
#if SKY
  e += sky_irradiance(r, frame.sky, emitter_rays, float(emitter_rays));
#endif
#endif
  texels[i].radiance = light_of(inverse_pi * s.albedo * e);
}
