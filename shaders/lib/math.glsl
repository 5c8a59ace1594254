// Constants and small helpers.
#ifndef LOOM_LIB_MATH_GLSL
#define LOOM_LIB_MATH_GLSL

const float pi = 3.14159265358979;
const float inverse_pi = 0.318309886183791;

// Luminance of linear Rec.709.
float luminance(vec3 rgb) { return dot(rgb, vec3(.2126, .7152, .0722)); }

// `v` scaled to length 1, or `fallback` where v has no direction (shorter than the smallest normal float's root,
// below which its square is lost).
vec3 normalize_or(vec3 v, vec3 fallback) {
  float square = dot(v, v);
  return square > 1.2e-38 ? v * inversesqrt(square) : fallback;
}

// Two unit vectors that complete the unit vector n to a right-handed basis (columns tangent, bitangent, n).
// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
mat3 orthonormal_basis(vec3 n) {
  float s = n.z >= 0. ? 1. : -1.;
  float a = -1. / (s + n.z);
  float b = n.x * n.y * a;
  return mat3(vec3(1. + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}
#endif
