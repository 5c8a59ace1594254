// Merges the areas that one buffer (a light, the camera) saw, then clears them. A wall that several buffers see is the
// wall of the buffer that sees most of it: areas are not added up over buffers.
#include "inject/inject.glsl"
layout(local_size_x = 32) in;

layout(rgba32f) uniform image3D blockers_occupancy;
#if ALBEDO
layout(rgba16f) uniform writeonly image3D blockers_albedo;
#endif
uniform float area_scale;

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  int count = cell_count(), k = grid_index(grid, cell);
  vec4 occupancy = imageLoad(blockers_occupancy, cell);
  for (int axis = 0; axis < 3; ++axis) {
    int at = 4 * axis * count + k;
    float amount = float(area[at]);
    float share = min(1.0, amount / area_scale);
    if (share > occupancy[axis]) {
      occupancy[axis] = share;
#if ALBEDO
      vec3 albedo = vec3(area[at + count], area[at + 2 * count], area[at + 3 * count]) / amount;
      imageStore(blockers_albedo, cell + ivec3(0, 0, axis * grid.cells.z), vec4(albedo, 1));
#endif
    }
    for (int i = 0; i < 4; ++i) area[at + i * count] = 0u;
  }
  imageStore(blockers_occupancy, cell, occupancy);
}
