// Merges the areas that one buffer (a light, the camera) saw, then clears them. A wall that several buffers see is the
// wall of the buffer that sees most of it: areas are not added up over buffers.
#include "inject/inject.glsl"
layout(local_size_x = 32) in;

layout(std430) buffer scratch_area { uint area[]; };
layout(rgba32f) uniform image3D blockers_occupancy;
#if ALBEDO
layout(rgba16f) uniform writeonly image3D blockers_albedo;
#endif
#if DIRECTIONAL
layout(std430) buffer scratch_directional { int directional[]; };
layout(rgba32f) uniform image3D blockers_directional;
#endif
uniform float area_scale;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  ivec3 to = volume_texel(cell);
  int count = cell_count(), k = grid_index(grid, cell);
  vec4 occupancy = imageLoad(blockers_occupancy, to);
  for (int axis = 0; axis < 3; ++axis) {
    int at = 4 * axis * count + k;
    float amount = float(area[at]);
    float share = min(1.0, amount / area_scale);
    if (share > occupancy[axis]) {
      occupancy[axis] = share;
#if ALBEDO
      vec3 albedo = vec3(area[at + count], area[at + 2 * count], area[at + 3 * count]) / amount;
      imageStore(blockers_albedo, to + ivec3(0, 0, axis * grid.cells.w * grid.cells.z), vec4(albedo, 1));
#endif
    }
    for (int i = 0; i < 4; ++i) area[at + i * count] = 0u;
  }
  imageStore(blockers_occupancy, to, occupancy);
#if DIRECTIONAL
  vec4 seen;
  for (int i = 0; i < 4; ++i) {
    seen[i] = float(directional[i * count + k]) * (4.0 / area_scale);
    directional[i * count + k] = 0;
  }
  if (seen.x > imageLoad(blockers_directional, to).x) imageStore(blockers_directional, to, seen);
#endif
}
