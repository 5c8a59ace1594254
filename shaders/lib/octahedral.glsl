// The octahedral map between unit directions and the square [−1, 1]². Cigolle et al., "A Survey of Efficient
// Representations for Independent Unit Vectors", JCGT 3(2), 2014.
#ifndef LOOM_LIB_OCTAHEDRAL_GLSL
#define LOOM_LIB_OCTAHEDRAL_GLSL

vec2 octahedral_encode(vec3 w) {
  vec2 p = w.xy / (abs(w.x) + abs(w.y) + abs(w.z));
  vec2 side = vec2(p.x >= 0. ? 1. : -1., p.y >= 0. ? 1. : -1.);
  return w.z >= 0. ? p : (1. - abs(p.yx)) * side;
}

vec3 octahedral_decode(vec2 p) {
  float z = 1. - abs(p.x) - abs(p.y);
  vec2 side = vec2(p.x >= 0. ? 1. : -1., p.y >= 0. ? 1. : -1.);
  return normalize(vec3(z >= 0. ? p : (1. - abs(p.yx)) * side, z));
}

// The same for the hemisphere about +z alone, over the whole square: the diamond of its directions, turned by 45°.
vec2 hemisphere_encode(vec3 w) {
  vec2 p = w.xy / max(abs(w.x) + abs(w.y) + max(0., w.z), 1e-30);
  return vec2(p.x + p.y, p.x - p.y);
}

vec3 hemisphere_decode(vec2 e) {
  vec2 p = .5 * vec2(e.x + e.y, e.x - e.y);
  return normalize(vec3(p, 1. - abs(p.x) - abs(p.y)));
}

// The texel of a map of size² that continues it beyond its border by one: each edge is glued to itself, turned round
// its middle, and each corner to the opposite one.
ivec2 octahedral_wrap(ivec2 texel, int size) {
  if (texel.x < 0 || texel.x >= size) texel = ivec2(clamp(texel.x, 0, size - 1), size - 1 - texel.y);
  if (texel.y < 0 || texel.y >= size) texel = ivec2(size - 1 - texel.x, clamp(texel.y, 0, size - 1));
  return clamp(texel, ivec2(0), ivec2(size - 1));
}
#endif
