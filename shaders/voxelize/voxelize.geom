// Projects each triangle along the axis it faces most, and covers every column of cells that it may touch: the whole
// columns of its bounding box (conservative rasterisation; the fragment stage clips exactly).
#include "interop/grid.h"
#include "lib/axes.glsl"
#include "lib/grid.glsl"
layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;
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

void main() {
  vec3 p[3];
  for (int i = 0; i < 3; ++i) p[i] = grid_coordinates(grid, 0, gl_in[i].gl_Position.xyz);
  vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
  int along = dominant_axis(normal);
  for (int i = 0; i < 3; ++i) p[i] = turn_axis_last(p[i], along);
  float doubled = turn_axis_last(normal, along).z;
  if (!(abs(doubled) > 0.)) return;  // no area, or not a number

  vec2 limit = turn_axis_last(vec3(grid.cells.xyz), along).xy;
  vec2 low = clamp(floor(min(p[0], min(p[1], p[2])).xy), vec2(0), limit);
  vec2 high = clamp(ceil(max(p[0], max(p[1], p[2])).xy), vec2(0), limit);
  high = max(high, min(low + 1., limit));  // a triangle on a line between columns
  // Inside one column the attributes are the middle's: carried on to the corners they would leave the texture far behind.
  bool small = all(lessThanEqual(high - low, vec2(1)));

  for (int i = 0; i < 4; ++i) {
    vec2 q = vec2((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y);
    vec2 a = p[0].xy - q, b = p[1].xy - q, c = p[2].xy - q;
    vec3 w = vec3(b.x * c.y - b.y * c.x, c.x * a.y - c.y * a.x, a.x * b.y - a.y * b.x) / doubled;
    if (small) w = vec3(1. / 3.);
    gl_Position = vec4(2. * q / raster_size - 1., .5, 1);
    gl_PrimitiveID = gl_PrimitiveIDIn;
    SCENE_MIX_VARYINGS(vertex, vertex_in, w);
    corner_a = p[0];
    corner_b = p[1];
    corner_c = p[2];
    axis = along;
    EmitVertex();
  }
}
