// Flux of each cell: every side of a sheet is a Lambertian emitter of flux Φ = π·R·A about its normal, I(ω) += Φ/π·⟨n,ω⟩₊,
// in the cell that lies half a cell off it. A cell gathers from itself and its neighbours, so that sums have one order.
#include "lib/sh.glsl"
#include "lib/sheets.glsl"
#include "lib/storage.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

uniform sampler3D voxels_radiance;
layout(STORAGE_RGBA) uniform writeonly image3D flux_red;
#if CHANNELS > 1
layout(STORAGE_RGBA) uniform writeonly image3D flux_green;
layout(STORAGE_RGBA) uniform writeonly image3D flux_blue;
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  vec4 red = vec4(0), green = vec4(0), blue = vec4(0);
  for (int i = 0; i < 27; ++i) {
    ivec3 from = cell + ivec3(i % 3, (i / 3) % 3, i / 9) - 1;
    if (any(lessThan(from, ivec3(0))) || any(greaterThanEqual(from, grid.cells.xyz))) continue;
    for (int slab = 0; slab < 6; ++slab) {
      SheetSide s;
      ivec3 target;
      if (!sheet_side(from, slab >> 1, slab & 1, s)) continue;
      if (!grid_cell(grid, 0, s.position + .5 * grid.cascade[0].w * s.normal, target) || target != cell) continue;
      vec3 power = texelFetch(voxels_radiance, s.texel, 0).rgb * s.area;  // Φ/π, W/sr
      vec4 lobe = sh2_cosine_lobe(s.normal);
      red += power.r * lobe;
      green += power.g * lobe;
      blue += power.b * lobe;
    }
  }
  imageStore(flux_red, cell, stored(red));
#if CHANNELS > 1
  imageStore(flux_green, cell, stored(green));
  imageStore(flux_blue, cell, stored(blue));
#endif
}
