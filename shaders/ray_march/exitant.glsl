// What a side of a sheet sends out: what it reflects and, where straight emission counts, what it emits. To be included
// before lib/voxels.glsl.
#ifndef LOOM_RAY_MARCH_EXITANT_GLSL
#define LOOM_RAY_MARCH_EXITANT_GLSL
uniform sampler3D LIGHT;
#if EMISSION
uniform sampler3D voxels_emission;
#endif

vec3 exitant_radiance(ivec3 texel) {
  vec3 radiance = texelFetch(LIGHT, texel, 0).rgb;
#if EMISSION
  radiance += texelFetch(voxels_emission, texel, 0).rgb;
#endif
  return radiance;
}

#define SHEET_RADIANCE(cell, slab) exitant_radiance(cell + ivec3(0, 0, (slab) * grid.cells.z))
#endif
