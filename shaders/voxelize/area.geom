// Covers every column of cells that the triangle may touch: the whole columns of its bounding box (conservative
// rasterisation; the fragment stage cuts exactly).
#include "voxelize/project.glsl"
layout(triangle_strip, max_vertices = 4) out;

void main() {
  Projected t;
  if (!project(t)) return;
  vec2 limit = turn_axis_last(vec3(grid.cells.xyz), t.axis).xy;
  vec2 low = clamp(floor(min(t.corner[0], min(t.corner[1], t.corner[2])).xy), vec2(0), limit);
  vec2 high = clamp(ceil(max(t.corner[0], max(t.corner[1], t.corner[2])).xy), vec2(0), limit);
  high = max(high, min(low + 1., limit));  // a triangle on a line between columns
  // Inside one column the attributes are the middle's: carried on to the corners they would leave the texture far behind.
  bool small = all(lessThanEqual(high - low, vec2(1)));
  for (int i = 0; i < 4; ++i) {
    vec2 q = vec2((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y);
    emit_corner(t, q, small ? vec3(1. / 3.) : weights_at(t, q));
  }
}
