// Where the voxelized scene shines: a pyramid of what the sides of the sheets send out, to aim rays by. The power of a side
// is luminance × coverage × the area on which a ray can meet it, in cell faces; a coarser cell holds the sum of its eight
// finer ones. Levels lie one beside the other (ray_march/pyramid.glsl). To be included after lib/voxels.glsl.
#ifndef LOOM_RAY_MARCH_POWER_GLSL
#define LOOM_RAY_MARCH_POWER_GLSL
#include "ray_march/pyramid.glsl"

vec3 sheet_normal(ivec3 cell, int axis) {
  return normalize(texelFetch(voxels_plane, cell + ivec3(0, 0, axis * grid.cells.z), 0).xyz);
}

// Luminance × coverage: power over area.
float side_brightness(ivec3 cell, int slab) {
  vec3 radiance = exitant_radiance(cell + ivec3(0, 0, slab * grid.cells.z));
  return luminance(radiance) * texelFetch(voxels_coverage, cell, 0)[slab >> 1];
}

float side_power(ivec3 cell, int slab) {
  float brightness = side_brightness(cell, slab);
  if (brightness <= 0.) return 0.;
  vec4 extent = met_extent(cell, slab >> 1);
  vec2 span = extent.zw - extent.xy;
  return brightness * span.x * span.y / max(abs(sheet_normal(cell, slab >> 1)[slab >> 1]), 1e-3);
}
#endif
