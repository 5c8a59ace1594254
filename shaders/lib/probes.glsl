// Irradiance of a surface from the probes around it.
//
//   E(x, n) = Σ_p w_p E_p(n) / Σ_p w_p,   w_p = trilinear · (((1 + ⟨n_g,d⟩)/2)² + b) · V,
//
// d the direction from x to the probe, b a weight for probes behind the surface. V is the chance that nothing stands between, from the mean μ and the mean square
// of the distance that the probe sees in the direction of x (Chebyshev's bound, cubed as in Majercik et al., "Dynamic
// Diffuse Global Illumination with Ray-Traced Irradiance Fields", JCGT 8(2), 2019): 1 where |x − p| ≤ μ, else
// (σ²/(σ² + (|x − p| − μ)²))³. A probe that is off weighs nothing.
//
// The including file defines COEFFICIENTS, and GAUSSIANS (1: spherical Gaussians, 0: harmonics), and says how a probe is read: three functions, declared below.
#ifndef LOOM_LIB_PROBES_GLSL
#define LOOM_LIB_PROBES_GLSL
#include "interop/probes.h"
#include "lib/octahedral.glsl"
#if GAUSSIANS
#include "lib/spherical_gaussians.glsl"
#else
#include "lib/sh_bands.glsl"
#endif

vec4 probe_state(ivec3 probe);                  // offset from the grid point, metres; w: 1 on, 0 off
vec2 probe_moments(ivec3 probe, ivec2 texel);   // mean distance, metres, and mean square
vec3 probe_coefficient(ivec3 probe, int i);     // W/(m² sr)

// Below this no digit of a normalised sum means anything.
const float least_probe_weight = 1e-6;

int moments_size(ProbeGrid grid) { return int(grid.weights.x); }

vec3 probe_position(ProbeGrid grid, ivec3 probe, vec4 state) {
  return grid.lower.xyz + vec3(probe) * grid.spacing.xyz + state.xyz;
}

vec2 filtered_moments(ProbeGrid grid, ivec3 probe, vec3 direction) {
  int size = moments_size(grid);
  vec2 at = .5 * (octahedral_encode(direction) + 1.) * float(size) - .5;
  ivec2 corner = ivec2(floor(at));
  vec2 f = at - vec2(corner), sum = vec2(0);
  for (int i = 0; i < 4; ++i) {
    ivec2 offset = ivec2(i & 1, i >> 1);
    vec2 w = mix(1. - f, f, vec2(offset));
    sum += w.x * w.y * probe_moments(probe, octahedral_wrap(corner + offset, size));
  }
  return sum;
}

// `path`: from the probe to the surface. The map cannot tell apart what lies within half of one of its texels (√4π/R
// wide at distance 1), so that the surface is taken that far off along its normal: it must not shadow itself.
float probe_visibility(ProbeGrid grid, ivec3 probe, vec3 path, vec3 n) {
  vec3 lifted = path + n * (1.77245385 / grid.weights.x * length(path));
  float distance = length(lifted);
  if (distance <= 0.) return 1.;
  vec2 moments = filtered_moments(grid, probe, lifted / distance);
  float excess = min(distance, grid.spacing.w) - moments.x;
  if (excess <= 0.) return 1.;
  float variance = max(0., moments.y - moments.x * moments.x);
  float v = variance / (variance + excess * excess);
  return v * v * v;
}

float facing_weight(ProbeGrid grid, vec3 path, vec3 n) {
  float length2 = dot(path, path);
  float facing = length2 > 0. ? .5 - .5 * dot(path, n) * inversesqrt(length2) : 1.;
  return facing * facing + grid.weights.y;
}

vec3 probe_reading(ivec3 probe, float basis[COEFFICIENTS]) {
  vec3 e = vec3(0);
  for (int i = 0; i < COEFFICIENTS; ++i) {
#if !GAUSSIANS
    if (!sh_gives_irradiance(i)) continue;
#endif
    e += basis[i] * probe_coefficient(probe, i);
  }
  return e;
}

// All probes within two grid steps, with weights that fall with the distance; `seeing`: only as far as they see x.
vec4 wider_search(ProbeGrid grid, ivec3 base, vec3 x, vec3 n, float basis[COEFFICIENTS], bool seeing) {
  vec4 sum = vec4(0);
  ivec3 low = max(base - 1, ivec3(0)), high = min(base + 2, grid.counts.xyz - 1);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x_ = low.x; x_ <= high.x; ++x_) {
        ivec3 probe = ivec3(x_, y, z);
        vec4 state = probe_state(probe);
        if (state.w < .5) continue;
        vec3 path = x - probe_position(grid, probe, state);
        float step2 = dot(grid.spacing.xyz, grid.spacing.xyz);
        float w = facing_weight(grid, path, n) * step2 / (step2 + dot(path, path));
        if (seeing) w *= probe_visibility(grid, probe, path, n);
        if (w > least_probe_weight) sum += w * vec4(probe_reading(probe, basis), 1);
      }
    }
  }
  return sum;
}

// Σ basis·L over the coefficients L around x; n_g: geometric normal. Where none of the eight probes around x is on and sees it,
// the answer comes from the first that holds: those within two grid steps that see x; the eight, seeing or not; those
// within two steps, seeing or not; 0.
vec3 probe_irradiance(ProbeGrid grid, vec3 x, vec3 n_g, float basis[COEFFICIENTS]) {
  vec3 at = clamp((x - grid.lower.xyz) / grid.spacing.xyz, vec3(0), vec3(grid.counts.xyz - 1));
  ivec3 base = clamp(ivec3(floor(at)), ivec3(0), max(grid.counts.xyz - 2, ivec3(0)));
  vec3 f = at - vec3(base);
  vec4 seen = vec4(0), all = vec4(0);  // Σ w·E, Σ w
  for (int i = 0; i < 8; ++i) {
    ivec3 offset = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    vec3 share = mix(1. - f, f, vec3(offset));
    float trilinear = share.x * share.y * share.z;
    if (trilinear <= 0.) continue;
    ivec3 probe = min(base + offset, grid.counts.xyz - 1);
    vec4 state = probe_state(probe);
    if (state.w < .5) continue;
    vec3 path = x - probe_position(grid, probe, state);
    float w = trilinear * facing_weight(grid, path, n_g);
    vec4 reading = vec4(probe_reading(probe, basis), 1);
    all += w * reading;
    seen += w * probe_visibility(grid, probe, path, n_g) * reading;
  }
  if (seen.w <= least_probe_weight) seen = wider_search(grid, base, x, n_g, basis, true);
  if (seen.w <= least_probe_weight) seen = all;
  if (seen.w <= least_probe_weight) seen = wider_search(grid, base, x, n_g, basis, false);
  return seen.w > 0. ? max(vec3(0), seen.rgb / seen.w) : vec3(0);
}

// With which coefficients are weighted for the irradiance of a surface with shading normal n.
void probe_basis(vec3 n, out float basis[COEFFICIENTS]) {
#if GAUSSIANS
  sg_irradiance_basis(n, basis);
#else
  sh_irradiance_basis(n, basis);
#endif
}

// Irradiance, W/m².
vec3 probe_irradiance(ProbeGrid grid, vec3 x, vec3 n, vec3 n_g) {
  float basis[COEFFICIENTS];
  probe_basis(n, basis);
  return probe_irradiance(grid, x, n_g, basis);
}
#endif
