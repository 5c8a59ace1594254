// The real spherical harmonics in a unit direction up to band 3, without the Condon–Shortley phase, Y_lm at l² + l + m.
// The including file defines COEFFICIENTS: 1, 4, 9 or 16. framework/include/loom/harmonics.h is the same in C++.
#ifndef LOOM_LIB_SH_BASIS_GLSL
#define LOOM_LIB_SH_BASIS_GLSL

void sh_basis(vec3 w, out float basis[COEFFICIENTS]) {
  float x = w.x, y = w.y, z = w.z;
  basis[0] = .282094792;
#if COEFFICIENTS >= 4
  basis[1] = .488602512 * y;
  basis[2] = .488602512 * z;
  basis[3] = .488602512 * x;
#endif
#if COEFFICIENTS >= 9
  basis[4] = 1.09254843 * x * y;
  basis[5] = 1.09254843 * y * z;
  basis[6] = .315391565 * (3. * z * z - 1.);
  basis[7] = 1.09254843 * x * z;
  basis[8] = .546274215 * (x * x - y * y);
#endif
#if COEFFICIENTS >= 16
  basis[9] = .590043590 * y * (3. * x * x - y * y);
  basis[10] = 2.89061144 * x * y * z;
  basis[11] = .457045799 * y * (5. * z * z - 1.);
  basis[12] = .373176333 * z * (5. * z * z - 3.);
  basis[13] = .457045799 * x * (5. * z * z - 1.);
  basis[14] = 1.44530572 * z * (x * x - y * y);
  basis[15] = .590043590 * x * (x * x - 3. * y * y);
#endif
}
#endif
