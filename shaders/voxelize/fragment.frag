// Fragment clipping: each fragment goes to the slice that its depth lies in.
#include "voxelize/sampled.glsl"

void main() {
  Column column = column_of_fragment();
  add_sample(column, int(floor(height_at_middle(column))));
}
