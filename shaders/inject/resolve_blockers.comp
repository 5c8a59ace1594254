// Merges the areas that one buffer (a light, the camera) saw. A wall that several buffers see is the
// wall of the buffer that sees most of it: areas are not added up over buffers.
#include "inject/inject.glsl"
#include "lib/storage.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

layout(STORAGE_RGBA) uniform image3D blockers_occupancy;
#if ALBEDO
writeonly uniform image3D blockers_albedo;
#endif
#if DIRECTIONAL
layout(STORAGE_RGBA) uniform image3D blockers_directional;
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  ivec3 to = volume_texel(cell);
  int k = grid_index(grid, cell);
  vec4 occupancy = imageLoad(blockers_occupancy, to);
  for (int axis = 0; axis < 3; ++axis) {
    int slot = AXIS_SLOTS * axis;
    float area = read_sum(slot, k);
    vec3 albedo = vec3(0);
    for (int channel = 0; channel < CHANNELS; ++channel) albedo[channel] = read_sum(slot + 1 + channel, k);
    float share = min(1.0, area);
    if (share <= occupancy[axis]) continue;
    occupancy[axis] = share;
#if ALBEDO
    imageStore(blockers_albedo, to + ivec3(0, 0, axis * grid.cells.w * grid.cells.z), vec4(albedo / area, 1));
#endif
  }
  imageStore(blockers_occupancy, to, occupancy);
#if DIRECTIONAL
  vec4 seen = vec4(0);
  for (int i = 0; i < 4; ++i) seen[i] = read_sum(DIRECTION_SLOT + i, k);
  if (seen.x > imageLoad(blockers_directional, to).x) imageStore(blockers_directional, to, stored(seen));
#endif
}
