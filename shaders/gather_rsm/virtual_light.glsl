// A texel of a reflective shadow map as a virtual light, packed into what the gathering loop loads: two vectors.
struct VirtualLight {
  vec4 position;   // xyz: world, metres; w: A/π, the square of the radius of a disc of the texel's area, m²
  vec4 intensity;  // rgb: Φ/π, W/sr; w: bits of the unit normal, octahedral, 16 bits an axis (within 4e-5 radians)
};
// One a texel, [face][row][column].
layout(std430) SCRATCH_ACCESS buffer scratch_virtual_lights { VirtualLight virtual_lights[]; };

// Octahedral unit vectors: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
// 3(2), 2014.
uint pack_normal(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.) p = (1. - abs(p.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(p, vec2(0)));
  return packSnorm2x16(p);
}
vec3 unpack_normal(uint bits) {
  vec2 p = unpackSnorm2x16(bits);
  vec3 n = vec3(p, 1. - abs(p.x) - abs(p.y));
  float fold = max(-n.z, 0.);
  n.xy -= mix(vec2(-fold), vec2(fold), greaterThanEqual(n.xy, vec2(0)));
  return normalize(n);
}
