// What a side of a sheet sends out: what it reflects and, where straight emission counts, what it emits. To be included
// before lib/voxels.glsl. LIGHT: the sampler of what sheets reflect, where anything lights them.
#ifndef LOOM_LIB_EXITANT_SHEETS_GLSL
#define LOOM_LIB_EXITANT_SHEETS_GLSL
#ifdef LIGHT
uniform sampler3D LIGHT;
#endif
#if EMISSION
uniform sampler3D voxels_emission;
#endif

vec3 exitant_radiance(ivec3 texel) {
  vec3 radiance = vec3(0);
#ifdef LIGHT
  radiance += texelFetch(LIGHT, texel, 0).rgb;
#endif
#if EMISSION
  radiance += texelFetch(voxels_emission, texel, 0).rgb;
#endif
  return radiance;
}

#define SHEET_RADIANCE(cell, slab) exitant_radiance(cell + ivec3(0, 0, (slab) * grid.cells.z))
#endif
