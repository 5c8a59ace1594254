// Irradiance from radiance as a sum of twelve spherical Gaussians G_i(v) = a_i·exp(λ(⟨v,μ_i⟩ − 1)) about the corners of an
// icosahedron. A Gaussian is zonal, with the coefficients 2π·I_l, I_l = ∫ exp(λ(c−1)) P_l(c) dc over −1…1, for which
//   I_0 = (1 − e^(−2λ))/λ,   I_1 = (1 + e^(−2λ) − I_0)/λ,   I_(l+1) = I_(l−1) − (2l+1)/λ·I_l,
// so that its irradiance on a plane with normal n is E_i(n) = Σ A_l (2l+1)/2 I_l P_l(⟨n,μ_i⟩), A = π, 2π/3, π/4, 0, −π/24.
#ifndef LOOM_LIB_SPHERICAL_GAUSSIANS_GLSL
#define LOOM_LIB_SPHERICAL_GAUSSIANS_GLSL

const float sg_sharpness = 3.;  // λ, as in passes/radiance_field/texel_weights.cpp

// Corner i of the icosahedron: cyclic permutations of (0, ±1, ±φ), unit.
vec3 sg_axis(int i) {
  vec3 axis = vec3(0);
  axis[(i / 4 + 1) % 3] = (i & 1) == 0 ? .525731112 : -.525731112;
  axis[(i / 4 + 2) % 3] = (i & 2) == 0 ? .850650808 : -.850650808;
  return axis;
}

// E_i(n) of each Gaussian with a_i = 1.
void sg_irradiance_basis(vec3 n, out float basis[COEFFICIENTS]) {
  const float l = sg_sharpness, tail = exp(-2. * l);
  float i0 = (1. - tail) / l, i1 = (1. + tail - i0) / l, i2 = i0 - 3. / l * i1, i3 = i1 - 5. / l * i2;
  float i4 = i2 - 7. / l * i3;
  for (int i = 0; i < COEFFICIENTS; ++i) {
    float c = dot(n, sg_axis(i)), cc = c * c;
    // A_l·(2l+1)/2 = π/2, π, 5π/8, 0, −3π/16.
    basis[i] = 1.57079633 * i0 + 3.14159265 * i1 * c + 1.96349541 * i2 * (1.5 * cc - .5) -
               .589048623 * i4 * (4.375 * cc * cc - 3.75 * cc + .375);
  }
}
#endif
