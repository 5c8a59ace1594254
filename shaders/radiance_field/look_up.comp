// What the probes see reflects what the voxelized scene reflects there, of all the orders that it holds: of the cell that
// the point lies in, the side of the sheet that looks the way the surface does.
#include "lib/axes.glsl"
#include "lib/grid.glsl"
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;

layout(std140) uniform voxels_data { Grid voxels; };
uniform sampler3D voxels_coverage;
uniform sampler3D LIGHT;

// The sheet that a surface with normal n at x belongs to: of its dominant axis, or of another that it was merged into. A
// point on a cell's face may be in either cell, so that a little before and behind it count too.
bool find_side(vec3 x, vec3 n, out ivec3 texel) {
  texel = ivec3(0);
  for (int k = 0; k < 3; ++k) {
    float offset = .05 * voxels.cascade[0].w * (k == 0 ? 0. : k == 1 ? -1. : 1.);
    ivec3 cell;
    if (!grid_cell(voxels, 0, x + offset * n, cell)) continue;
    vec4 coverage = texelFetch(voxels_coverage, cell, 0);
    for (int turn = 0; turn < 3; ++turn) {
      int axis = (dominant_axis(n) + turn) % 3;
      if (coverage[axis] <= 0. || abs(n[axis]) < .3) continue;
      texel = cell + ivec3(0, 0, (2 * axis + (n[axis] > 0. ? 0 : 1)) * voxels.cells.z);
      return true;
    }
  }
  return false;
}

void main() {
  int t = int(gl_GlobalInvocationID.x), slot = int(gl_GlobalInvocationID.y);
  if (t >= texel_count() || slot >= slot_count) return;
  int i = slot * texel_count() + t, probe = probe_of(slot);
  float distance = texels[i].distance;
  if (distance == 0. || states[probe].w < .5) return;
  vec3 n = unpack_surfel(surfaces[i]).n_g;
  ivec3 texel;
  if (find_side(standing_at(probe) + abs(distance) * texel_direction(t), n, texel))
    texels[i].radiance = light_of(texelFetch(LIGHT, texel, 0).rgb);
}
