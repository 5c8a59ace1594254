// The sides that rays of this frame are aimed at: drawn by their shares of all power, one in each of as many equal parts of
// it as there are targets.
#include "interop/frame.h"
#include "lib/sampling.glsl"
#include "lib/exitant_sheets.glsl"
// After what sheets send out is known.
#include "lib/voxels.glsl"
#include "ray_march/power.glsl"
layout(local_size_x = 64) in;

layout(std140) uniform frame_data { FrameData frame; };
uniform sampler3D scratch_power;
uniform int levels;
layout(std430) buffer scratch_targets {
  float total_power;
  int target_count;
  ivec4 targets[];
};

float power_of(ivec3 cell, int level) {
  if (any(greaterThanEqual(cell, level_cells(grid.cells.xyz, level)))) return 0.;
  return texelFetch(scratch_power, level_corner(grid.cells.xyz, level, 0) + cell, 0).r;
}

// Goes down the pyramid: of eight cells one, by its share; then of six sides one.
ivec4 choose_side(float u) {
  ivec3 cell = ivec3(0);
  for (int level = levels - 2; level >= 0; --level) {
    float left = u * power_of(cell, level + 1);
    ivec3 found = 2 * cell;
    float power = 0.;
    bool searching = true;
    for (int i = 0; i < 8 && searching; ++i) {
      ivec3 child = 2 * cell + ivec3(i & 1, (i >> 1) & 1, i >> 2);
      float share = power_of(child, level);
      if (share <= 0.) continue;
      found = child;
      power = share;
      searching = left >= share;
      if (searching) left -= share;
    }
    cell = found;
    u = power > 0. ? clamp(left / power, 0., .999999) : 0.;
  }
  float left = u * power_of(cell, 0);
  int slab = -1;
  bool searching = true;
  for (int i = 0; i < 6 && searching; ++i) {
    float share = side_power(cell, i);
    if (share <= 0.) continue;
    slab = i;
    searching = left >= share;
    left -= share;
  }
  return ivec4(cell, slab);
}

void main() {
  int id = int(gl_GlobalInvocationID.x), count = targets.length();
  if (id >= count) return;
  if (id == 0) {
    total_power = power_of(ivec3(0), levels - 1);
    target_count = count;
  }
  float jitter = float(hash(uvec4(uint(id), frame.random.xyz)).x) / 4294967296.;
  targets[id] = choose_side((float(id) + jitter) / float(count));
}
