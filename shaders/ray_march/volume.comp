// Light that arrives at the cells of a coarse grid, by rays in all directions, as an intensity volume: the radiance
// coefficients 4π/N · Σ L(ω)·Y(−ω), −ω the way the light travels, times 3s²/2 (GatherVolume reads L = 2I/(3s²)).
#include "interop/frame.h"
#include "lib/sampling.glsl"
#include "lib/sh.glsl"
#include "lib/sky.glsl"
#include "lib/storage.glsl"
#if SLEEPS
#include "ray_march/cells.glsl"
#endif
#include "lib/exitant_sheets.glsl"
// After what sheets send out is known.
#include "lib/voxels.glsl"
layout(local_size_x = 4, local_size_y = 4, local_size_z = 2) in;

layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform volume_data { Grid probes; };
layout(STORAGE_RGBA) uniform image3D volume_red;
#if CHANNELS > 1
layout(STORAGE_RGBA) uniform image3D volume_green;
layout(STORAGE_RGBA) uniform image3D volume_blue;
#endif
uniform int rays;
uniform ivec2 part;  // of the rays: the first, and the one after the last

void store(ivec3 cell, vec4 red, vec4 green, vec4 blue) {
  bool first = part.x == 0;
  imageStore(volume_red, cell, stored(first ? red : imageLoad(volume_red, cell) + red));
#if CHANNELS > 1
  imageStore(volume_green, cell, stored(first ? green : imageLoad(volume_green, cell) + green));
  imageStore(volume_blue, cell, stored(first ? blue : imageLoad(volume_blue, cell) + blue));
#endif
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, probes.cells.xyz))) return;
#if SLEEPS
  uint state = imageLoad(persistent_cells, cell).r;
  if (state == marched) return;
  if (state == asleep) {
    store(cell, vec4(0), vec4(0), vec4(0));
    return;
  }
  if (part.y >= rays) imageStore(persistent_cells, cell, uvec4(marched));
#endif
  float size = probes.cascade[0].w;
  vec3 centre = probes.cascade[0].xyz + (vec3(cell) + .5) * size;
  uint seed = hash(uvec4(uvec3(cell), frame.random.x)).x;
  vec4 red = vec4(0), green = vec4(0), blue = vec4(0);
  for (int k = part.x; k < part.y; ++k) {
    vec3 w = uniform_sphere(low_discrepancy(uint(k), seed));
    March ray = march(centre, w, vec3(0), 1e30);
    vec3 radiance = ray.radiance;
#if EMITTER
    radiance += ray.transmittance * sky_radiance(frame.sky, w, 4. * pi / float(rays));
#endif
    vec4 y = sh2_basis(-w);
    red += radiance.r * y;
    green += radiance.g * y;
    blue += radiance.b * y;
  }
  float scale = 4. * pi / float(rays) * 1.5 * size * size;
  store(cell, scale * red, scale * green, scale * blue);
}
