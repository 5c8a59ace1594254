// A texel of a reflective shadow map as a virtual light.
struct VirtualLight {
  vec4 position;   // xyz: world, metres; w: A/π, the square of the radius of a disc of the texel's area, m²
  vec4 normal;     // xyz: unit; w: 1/(solid angle) in 1/sr (directional: 1/m²)
  vec4 intensity;  // rgb: Φ/π, W/sr
};
// One a texel, [face][row][column].
layout(std430) SCRATCH_ACCESS buffer scratch_virtual_lights { VirtualLight virtual_lights[]; };
