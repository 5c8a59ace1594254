// Wakes the cells of the volume that GatherVolume reads for the surface of each pixel: the eight around the point half a
// cell off it.
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/grid.glsl"
#include "ray_march/cells.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform readers_data { Camera camera; };
layout(std140) uniform volume_data { Grid probes; };
uniform sampler2D readers_depth;
uniform sampler2D readers_normal;

// In cells: a sampler's weights have four bits of fraction at least, and two programs may round differently.
const float slack = 1. / 16.;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(readers_depth, 0)))) return;
  float depth = texelFetch(readers_depth, pixel, 0).r;
  if (depth <= 0.) return;
  vec3 n = normalize(texelFetch(readers_normal, pixel, 0).xyz);
  vec3 x = surface_position(camera, (vec2(pixel) + .5) * camera.size.zw, depth), cells = vec3(probes.cells.xyz);
  vec3 at = clamp(grid_coordinates(probes, 0, x + .5 * probes.cascade[0].w * n), vec3(.5), cells - .5) - .5;
  ivec3 low = max(ivec3(floor(at - slack)), ivec3(0)), high = min(ivec3(floor(at + slack)) + 1, probes.cells.xyz - 1);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x_ = low.x; x_ <= high.x; ++x_) {
        ivec3 cell = ivec3(x_, y, z);
        if (imageLoad(persistent_cells, cell).r == asleep) imageStore(persistent_cells, cell, uvec4(awake));
      }
    }
  }
}
