// What the geometry stages share: each triangle in cells, projected along the axis that it faces most.
#ifndef LOOM_VOXELIZE_PROJECT_GLSL
#define LOOM_VOXELIZE_PROJECT_GLSL
#include "interop/grid.h"
#include "lib/axes.glsl"
#include "lib/grid.glsl"
layout(triangles) in;
// The same block twice: as input an array, as output one vertex.
#define SCENE_VARYING in
#define vertex vertex_in[]
#include "lib/scene_varyings.glsl"
#undef vertex
#undef SCENE_VARYING
#undef LOOM_LIB_SCENE_VARYINGS_GLSL
#define SCENE_VARYING out
#include "lib/scene_varyings.glsl"

layout(std140) uniform voxels_data { Grid grid; };
uniform float raster_size;  // side of the raster, columns

flat out vec3 corner_a;  // in cells, turned: the dominant axis last
flat out vec3 corner_b;
flat out vec3 corner_c;
flat out int axis;

struct Projected {
  vec3 corner[3];
  int axis;
  float doubled;  // twice the area of the projection, signed
};

// False where the triangle has no area, or is not a number.
bool project(out Projected t) {
  for (int i = 0; i < 3; ++i) t.corner[i] = grid_coordinates(grid, 0, gl_in[i].gl_Position.xyz);
  vec3 normal = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
  t.axis = dominant_axis(normal);
  for (int i = 0; i < 3; ++i) t.corner[i] = turn_axis_last(t.corner[i], t.axis);
  t.doubled = turn_axis_last(normal, t.axis).z;
  return abs(t.doubled) > 0.;
}

// Barycentric coordinates of a point of the raster.
vec3 weights_at(Projected t, vec2 q) {
  vec2 a = t.corner[0].xy - q, b = t.corner[1].xy - q, c = t.corner[2].xy - q;
  return vec3(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x) / t.doubled;
}

// One corner of what is drawn of the triangle, with the attributes that the weights w mix.
void emit_corner(Projected t, vec2 q, vec3 w) {
  gl_Position = vec4(2. * q / raster_size - 1., .5, 1);
  gl_PrimitiveID = gl_PrimitiveIDIn;
  SCENE_MIX_VARYINGS(vertex, vertex_in, w);
  corner_a = t.corner[0];
  corner_b = t.corner[1];
  corner_c = t.corner[2];
  axis = t.axis;
  EmitVertex();
}
#endif
