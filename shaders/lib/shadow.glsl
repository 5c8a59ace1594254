// Visibility of a light by its shadow map.
//
// The test is done in world space: a texel stores the point p that the light sees through its centre, and the receiver
// at x with geometric normal n is in shadow where p stands in front of the receiver's own tangent plane,
//   ⟨n, p − x⟩ > bound.
// On a plane every texel, however slanted the light, stores a point of that very plane, so that no slope-dependent bias
// is needed (this is receiver-plane bias, written without its division, which fails at grazing angles). What is left
// over, and what the bound covers:
//  - The map is sampled: p may be seen through a neighbouring piece of the same surface. Nothing finer than a texel can
//    be told apart, so half a texel's width at p is granted. That is far more than the rasteriser's own error: positions
//    snapped to 1/256 texel move p off its plane by less than that share of the texel's width, whatever the slope.
//  - Rounding of x, of the depth and of p: 2⁻²⁰ of the largest coordinate.
// The price is stated by the same number: a blocker lower than half a texel above the receiver casts no shadow.
#ifndef LOOM_LIB_SHADOW_GLSL
#define LOOM_LIB_SHADOW_GLSL
#include "lib/rsm.glsl"

// Distance along `forward` from reversed hardware depth; 0 (nothing drawn) is infinitely far.
float shadow_distance(LightFace face, float hardware_depth) {
  return is_directional(face) ? (1. - hardware_depth) * face.right.w : face.right.w / hardware_depth;
}

// 1 where the light reaches x past what one texel stores, else 0. `n`: unit geometric normal on the lit side.
float texel_visibility(LightFace face, ivec2 texel, int size, float hardware_depth, vec3 x, vec3 n) {
  if (hardware_depth <= 0.) return 1.;
  vec2 q = texel_plane(texel, size);
  float z = shadow_distance(face, hardware_depth);
  vec3 across = q.x * face.right.xyz + q.y * face.up.xyz;
  vec3 p = face.origin.xyz + (is_directional(face) ? across + z * face.forward.xyz : z * (across + face.forward.xyz));
  vec3 m = max(abs(x), abs(p));
  float bound = .5 * texel_width(face, z, size) + 9.5367431640625e-7 * max(m.x, max(m.y, m.z));
  return dot(n, p - x) > bound ? 0. : 1.;
}

// Share of the light that reaches x through the face: the texel that x falls into, or with `filtered` the four nearest,
// each tested by itself and weighted bilinearly (percentage-closer filtering, Reeves et al. 1987).
float shadow_visibility(sampler2DArray map, LightFace face, int layer, vec2 q, vec3 x, vec3 n, bool filtered) {
  int size = textureSize(map, 0).x;
  vec2 at = .5 * (q + 1.) * float(size);
  if (!filtered) {
    ivec2 texel = clamp(ivec2(floor(at)), ivec2(0), ivec2(size - 1));
    return texel_visibility(face, texel, size, texelFetch(map, ivec3(texel, layer), 0).r, x, n);
  }
  ivec2 corner = ivec2(floor(at - .5));
  vec2 f = at - .5 - vec2(corner);
  float sum = 0.;
  for (int i = 0; i < 4; ++i) {
    ivec2 offset = ivec2(i & 1, i >> 1);
    ivec2 texel = clamp(corner + offset, ivec2(0), ivec2(size - 1));
    vec2 w = mix(1. - f, f, vec2(offset));
    sum += w.x * w.y * texel_visibility(face, texel, size, texelFetch(map, ivec3(texel, layer), 0).r, x, n);
  }
  return sum;
}
#endif
