// Real spherical harmonics without the Condon–Shortley phase, bands 0 and 1 packed as (c00, c1−1, c10, c11):
// Y00 = 1/(2√π), Y1 = √(3/4π)·(y, z, x). Volumes hold one such vector a channel.
#ifndef LOOM_LIB_SH_GLSL
#define LOOM_LIB_SH_GLSL

const float SH_Y0 = 0.28209479;  // 1/(2√π)
const float SH_Y1 = 0.48860251;  // √(3/(4π))

// The basis in a unit direction: dot() with coefficients evaluates them.
vec4 sh2_basis(vec3 w) { return vec4(SH_Y0, SH_Y1 * w.y, SH_Y1 * w.z, SH_Y1 * w.x); }

// Projection of the clamped cosine max(0, <w, axis>): zonal coefficients √π/2 and √(π/3).
vec4 sh2_cosine_lobe(vec3 axis) {
  const float z0 = 0.88622693, z1 = 1.02332671;
  return vec4(z0, z1 * axis.y, z1 * axis.z, z1 * axis.x);
}

#endif
