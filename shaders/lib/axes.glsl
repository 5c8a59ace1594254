// Coordinates turned so that one axis comes last: (u, v, w), w along the axis. The turn keeps orientation.
#ifndef LOOM_LIB_AXES_GLSL
#define LOOM_LIB_AXES_GLSL

vec3 turn_axis_last(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
vec3 turn_axis_back(vec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }
ivec3 turn_axis_back(ivec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }

// The axis along which n is longest.
int dominant_axis(vec3 n) {
  vec3 m = abs(n);
  return m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
}
#endif
