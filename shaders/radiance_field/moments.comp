// Mean and mean square of the distance that a probe sees, over each texel of an octahedral map. What lies farther than
// the cut-off is at the cut-off: it blocks nothing that the probe is asked for, and would only add to the variance.
// The back of a single-sided face is the inside of something: it counts as distance 0, since nothing on its front is seen
// from there. Otherwise a probe beyond a wall of one sheet would see that wall as near as the receiver on it.
#include "radiance_field/texels.glsl"
layout(local_size_x = 64) in;
layout(std430) writeonly restrict buffer MOMENTS_BLOCK { vec2 moments[]; };  // [probe][texel]

const int across = 4;  // directions along each side of a texel, denser than the cube's texels

void main() {
  int t = int(gl_GlobalInvocationID.x), slot = int(gl_GlobalInvocationID.y);
  int size = int(grid.weights.x);
  if (t >= size * size || slot >= slot_count) return;
  vec2 sum = vec2(0);
  for (int j = 0; j < across * across; ++j) {
    vec2 p = vec2(t % size, t / size) + (vec2(j % across, j / across) + .5) / float(across);
    float distance = texels[slot * texel_count() + texel_towards(octahedral_decode(2. * p / float(size) - 1.))].distance;
    distance = distance == 0. ? grid.spacing.w : clamp(distance, 0., grid.spacing.w);
    sum += vec2(distance, distance * distance);
  }
  moments[probe_of(slot) * size * size + t] = sum / float(across * across);
}
