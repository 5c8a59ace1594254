// Irradiance from radiance in real spherical harmonics up to band 4, without the Condon–Shortley phase, coefficient (l, m)
// at l² + l + m:  E(n) = Σ A_l Y_lm(n) L_lm,  A = π, 2π/3, π/4, 0, −π/24. The including file defines COEFFICIENTS, the
// number of coefficients: 1, 4, 9, 16 or 25.
#ifndef LOOM_LIB_SH_BANDS_GLSL
#define LOOM_LIB_SH_BANDS_GLSL

// The coefficients of band 3 give no irradiance (A_3 = 0) and need not be read.
bool sh_gives_irradiance(int i) { return i < 9 || i >= 16; }

// A_l·Y_lm(n) of each coefficient.
void sh_irradiance_basis(vec3 n, out float basis[COEFFICIENTS]) {
  float x = n.x, y = n.y, z = n.z;
  basis[0] = .886226925;  // π/(2√π)
#if COEFFICIENTS >= 4
  const float a1 = 1.02332671;  // 2π/3·√(3/4π)
  basis[1] = a1 * y;
  basis[2] = a1 * z;
  basis[3] = a1 * x;
#endif
#if COEFFICIENTS >= 9
  const float a2 = .858085531;  // π/4·½√(15/π)
  basis[4] = a2 * x * y;
  basis[5] = a2 * y * z;
  basis[6] = .247707956 * (3. * z * z - 1.);  // π/4·¼√(5/π)
  basis[7] = a2 * x * z;
  basis[8] = .5 * a2 * (x * x - y * y);
#endif
#if COEFFICIENTS >= 16
  for (int i = 9; i < 16; ++i) basis[i] = 0.;
#endif
#if COEFFICIENTS >= 25
  const float a4 = -.130899694;  // −π/24
  float xx = x * x, yy = y * y, zz = z * z;
  basis[16] = a4 * 2.50334294 * x * y * (xx - yy);
  basis[17] = a4 * 1.77013077 * y * z * (3. * xx - yy);
  basis[18] = a4 * .946174696 * x * y * (7. * zz - 1.);
  basis[19] = a4 * .669046544 * y * z * (7. * zz - 3.);
  basis[20] = a4 * .105785547 * (35. * zz * zz - 30. * zz + 3.);
  basis[21] = a4 * .669046544 * x * z * (7. * zz - 3.);
  basis[22] = a4 * .473087348 * (xx - yy) * (7. * zz - 1.);
  basis[23] = a4 * 1.77013077 * x * z * (xx - 3. * yy);
  basis[24] = a4 * .625835735 * (xx * (xx - 3. * yy) - yy * (3. * xx - yy));
#endif
}
#endif
