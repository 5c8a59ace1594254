// Blocked share of each cell's three lower faces: a sheet blocks the face nearest to it along each axis e, by
// A·|⟨n,e⟩|/s² of it. A face gathers from the two cells beside it.
#include "lib/sheets.glsl"
#include "lib/storage.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(STORAGE_RGBA) uniform writeonly image3D blockers_occupancy;
#if ALBEDO
writeonly uniform image3D blockers_albedo;
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  float size = grid.cascade[0].w;
  vec3 shares = vec3(0);
  for (int face = 0; face < 3; ++face) {
    vec3 albedo = vec3(0);
    float share = 0.;
    for (int beside = 0; beside < 2; ++beside) {
      ivec3 from = cell;
      from[face] -= beside;
      if (from[face] < 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        SheetSide positive, negative;
        if (!sheet_side(from, axis, 0, positive) || !sheet_side(from, axis, 1, negative)) continue;
        vec3 centre = grid.cascade[0].xyz + (vec3(from) + .5) * size;
        float height = .5 * (positive.position + negative.position - 2. * centre)[face];
        if ((height < 0.) != (beside == 0)) continue;  // the face on the other side is nearer
        float part = positive.area / (size * size) * abs(positive.normal[face]);
        share += part;
        albedo += part * .5 * (positive.albedo + negative.albedo);
      }
    }
    shares[face] = min(1., share);
#if ALBEDO
    imageStore(blockers_albedo, cell + ivec3(0, 0, face * grid.cells.z), vec4(share > 0. ? albedo / share : vec3(0), 1));
#endif
  }
  imageStore(blockers_occupancy, cell, vec4(shares, 0));
}
