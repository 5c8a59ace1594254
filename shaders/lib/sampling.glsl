// Directions and points from low-discrepancy sequences, decorrelated by hashing. Integer arithmetic throughout: the same
// seed gives the same samples on every device.
#ifndef LOOM_LIB_SAMPLING_GLSL
#define LOOM_LIB_SAMPLING_GLSL
#include "lib/math.glsl"

// pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
uvec4 hash(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// Uniform in [0,1): the upper 24 bits, all that a float holds exactly.
float to_unit(uint bits) { return float(bits >> 8) * 5.9604644775390625e-8; }

// A seed for one pixel. `random` is FrameData.random (seed, frame, sub-pixel sample); `stream` tells apart the decisions
// of one pixel, such as the light to choose and the point on it.
uint pixel_seed(uvec2 pixel, uvec4 random, uint stream) {
  return hash(uvec4(pixel, random.x ^ stream * 0x9e3779b9u, random.y + random.z * 0x10001u)).x;
}

// Owen scrambling by a hash that lets every bit depend on the higher ones alone; works on reversed bits.
// Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, with the constants of Vegdahl's later search.
uint owen_scramble_reversed(uint x, uint seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}
uint owen_scramble(uint x, uint seed) { return bitfieldReverse(owen_scramble_reversed(bitfieldReverse(x), seed)); }

// Point `index` of the first two dimensions of Sobol's sequence, as bits of a fraction. The first is the radical
// inverse; the second multiplies the index by Pascal's triangle modulo 2, done by halves.
uvec2 sobol(uint index) {
  uint y = index;
  y ^= (y & 0xaaaaaaaau) >> 1;
  y ^= (y & 0xccccccccu) >> 2;
  y ^= (y & 0xf0f0f0f0u) >> 4;
  y ^= (y & 0xff00ff00u) >> 8;
  y ^= y >> 16;
  return bitfieldReverse(uvec2(index, y));
}

// Point `index` of a shuffled and scrambled Sobol sequence, in [0,1)². Every 2ᵏ consecutive points from a multiple of
// 2ᵏ are a (0,k,2)-net: exactly one in each box of area 2⁻ᵏ. Different seeds are independent, so that more dimensions
// come from more seeds.
vec2 low_discrepancy(uint index, uint seed) {
  uvec4 h = hash(uvec4(seed, 0x68bc21ebu, 0x02e5be93u, 0x967a889bu));
  uvec2 bits = sobol(owen_scramble(index, h.x));
  return vec2(to_unit(owen_scramble(bits.x, h.y)), to_unit(owen_scramble(bits.y, h.z)));
}

// Direction about +z with density cosθ/π.
vec3 cosine_hemisphere(vec2 u) {
  float r = sqrt(u.x), angle = 2. * pi * u.y;
  return vec3(r * cos(angle), r * sin(angle), sqrt(1. - u.x));
}
// The same about the unit vector n.
vec3 cosine_hemisphere(vec2 u, vec3 n) { return orthonormal_basis(n) * cosine_hemisphere(u); }

// Direction on the unit sphere, density 1/(4π).
vec3 uniform_sphere(vec2 u) {
  float z = 1. - 2. * u.x, r = sqrt(max(0., 1. - z * z)), angle = 2. * pi * u.y;
  return vec3(r * cos(angle), r * sin(angle), z);
}

// Barycentrics of a point uniform on a triangle: (1−x−y)·a + x·b + y·c.
vec2 uniform_triangle(vec2 u) {
  float root = sqrt(u.x);
  return vec2(root * (1. - u.y), root * u.y);
}
#endif
