// Level 0 of the pyramid: of each cell the sheets, as far as they face the direction.
#include "lib/exitant_sheets.glsl"
// After what sheets send out is known.
#include "lib/sheets.glsl"
#include "lib/storage.glsl"
#include "ray_march/pyramid.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(STORAGE_RGBA) uniform writeonly image3D scratch_pyramid;

void main() {
  ivec3 id = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(id, imageSize(scratch_pyramid)))) return;
  if (id.x >= grid.cells.x) {  // the coarser levels, and what lies between them: filtering reads it, with weight 0
    imageStore(scratch_pyramid, id, vec4(0));
    return;
  }
  int slab = id.z / grid.cells.z, along = slab >> 1;
  ivec3 cell = ivec3(id.xy, id.z - slab * grid.cells.z);
  float towards = (slab & 1) == 0 ? 1. : -1.;
  float face = grid.cascade[0].w * grid.cascade[0].w;
  vec4 sum = vec4(0);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      SheetSide s;
      if (!sheet_side(cell, axis, side, s) || towards * s.normal[along] <= 0.) continue;
      float share = s.area / face * abs(s.normal[along]);  // of the cell's face that the side fills
      sum += share * vec4(exitant_radiance(s.texel), 1);
    }
  }
  imageStore(scratch_pyramid, level_corner(grid.cells.xyz, 0, slab) + cell, stored(sum.a > 1. ? sum / sum.a : sum));
}
