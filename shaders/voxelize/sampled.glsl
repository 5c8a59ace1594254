// A fragment of a triangle that covers the middle of its column stands for all of the column: it adds the plane's area
// over it to one cell.
#ifndef LOOM_VOXELIZE_SAMPLED_GLSL
#define LOOM_VOXELIZE_SAMPLED_GLSL
#include "voxelize/surfel.glsl"

float height_at_middle(Column column) { return height_at(column, vec2(.5)); }

void add_sample(Column column, int slice) {
  Surfel surfel = surfel_of_fragment(column);
  float share = opaque_share();
  if (share <= 0. || slice < 0 || slice >= column.depth) return;
  float height = height_at_middle(column) - float(slice), reach = .5 * (abs(column.slope.x) + abs(column.slope.y));
  add_piece(column, slice, surfel, share / abs(column.normal.z), vec3(.5, .5, height), vec3(0, 0, height - reach),
            vec3(1, 1, height + reach));
}
#endif
