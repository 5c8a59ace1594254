// One order of reflection at one probe a work group: L_i = Σ_t W_i(t)·L(ω_t), for spherical harmonics with
// W = Y_lm(ω_t)·Δω_t. Order 0 is the light of the first reflection; in every further one what the texel shows reflects the
// irradiance of the order before, L = ρ/π·E.
#include "radiance_field/texels.glsl"
#include "lib/math.glsl"
#include "lib/probes.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer scratch_weights { float weights[]; };  // [texel][coefficient]
layout(std430) restrict buffer ORDERS_BLOCK { Light orders[]; };               // [order][probe][coefficient]
layout(std430) readonly restrict buffer MOMENTS_BLOCK { vec2 moments[]; };
uniform int reflection;  // order, from 0

vec4 probe_state(ivec3 probe) { return states[probe_index(probe)]; }
vec2 probe_moments(ivec3 probe, ivec2 texel) {
  int size = moments_size(grid);
  return moments[(probe_index(probe) * size + texel.y) * size + texel.x];
}
vec3 probe_coefficient(ivec3 probe, int i) {
  return vec3(orders[((reflection - 1) * probe_count() + probe_index(probe)) * COEFFICIENTS + i]);
}

vec3 radiance(int slot, int probe, int t) {
  int i = slot * texel_count() + t;
  Texel texel = texels[i];
  if (texel.distance == 0.) return vec3(0);
  if (reflection == 0) return vec3(texel.radiance);
  Surfel s = unpack_surfel(surfaces[i]);
  if (s.albedo == vec3(0)) return vec3(0);
  vec3 x = standing_at(probe) + abs(texel.distance) * texel_direction(t);
  return inverse_pi * s.albedo * probe_irradiance(grid, x, s.n, s.n_g);
}

const int chunk = 384;
shared Light seen[chunk];

void main() {
  int slot = int(gl_WorkGroupID.x), lane = int(gl_LocalInvocationID.x);
  int probe = probe_of(slot);
  bool on = slot < slot_count && states[probe].w > .5;
  Light sum = Light(0);
  for (int first = 0; first < texel_count(); first += chunk) {
    int count = min(chunk, texel_count() - first);
    barrier();
    for (int k = lane; k < count; k += 64) {
      seen[k] = light_of(on ? radiance(slot, probe, first + k) : vec3(0));
    }
    barrier();
    if (lane < COEFFICIENTS) {
      for (int k = 0; k < count; ++k) sum += weights[(first + k) * COEFFICIENTS + lane] * seen[k];
    }
  }
  if (lane < COEFFICIENTS && slot < slot_count) {
    orders[(reflection * probe_count() + probe) * COEFFICIENTS + lane] = sum;
  }
}
