// Adds one buffer's fixed-point sums to the volumes, then clears them. Fluxes of several lights add up; a wall that
// several buffers see is the wall of the buffer that sees most of it.
#include "inject/inject.glsl"
layout(local_size_x = 32) in;

layout(rgba32f) uniform image3D flux_red;
layout(rgba32f) uniform image3D flux_green;
layout(rgba32f) uniform image3D flux_blue;
layout(std430) buffer scratch_fixed { int fixed_flux[]; };
#if BLOCKERS
layout(rgba32f) uniform image3D blockers_occupancy;
layout(rgba16f) uniform writeonly image3D blockers_albedo;
uniform float area_scale;
#endif
uniform float flux_scale;  // 0: this buffer carries no flux

vec4 take(int channel, int k, int count) {
  vec4 c;
  for (int i = 0; i < 4; ++i) {
    int at = (4 * channel + i) * count + k;
    c[i] = float(fixed_flux[at]) / flux_scale;
    fixed_flux[at] = 0;
  }
  return c;
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  int k = grid_index(grid, cell), count = cell_count();
  if (flux_scale > 0.0) {
    imageStore(flux_red, cell, imageLoad(flux_red, cell) + take(0, k, count));
    imageStore(flux_green, cell, imageLoad(flux_green, cell) + take(1, k, count));
    imageStore(flux_blue, cell, imageLoad(flux_blue, cell) + take(2, k, count));
  }
#if BLOCKERS
  vec4 occupancy = imageLoad(blockers_occupancy, cell);
  for (int axis = 0; axis < 3; ++axis) {
    int at = 4 * axis * count + k;
    float amount = float(area[at]);
    float share = min(1.0, amount / area_scale);
    if (share > occupancy[axis]) {
      occupancy[axis] = share;
      vec3 albedo = vec3(area[at + count], area[at + 2 * count], area[at + 3 * count]) / amount;
      imageStore(blockers_albedo, cell + ivec3(0, 0, axis * grid.cells.z), vec4(albedo, 1));
    }
    for (int i = 0; i < 4; ++i) area[at + i * count] = 0u;
  }
  imageStore(blockers_occupancy, cell, occupancy);
#endif
}
