// The triangle as it is: fragments find their slices themselves.
#include "voxelize/project.glsl"
layout(triangle_strip, max_vertices = 3) out;

void main() {
  Projected t;
  if (!project(t)) return;
  for (int i = 0; i < 3; ++i) emit_corner(t, t.corner[i].xy, vec3(equal(ivec3(i), ivec3(0, 1, 2))));
}
