// Row i of a point's transfer, M_ij = 4π/N·Σ Y_i(ω)·Y_j(exit)·weight over its paths; or, beyond the rows, a texel of the
// map of distances.
#include "lib/octahedral.glsl"
#include "lib/sh_basis.glsl"
#include "prt/lattice.glsl"
#include "prt/paths.glsl"
layout(local_size_x = 64) in;
layout(std430) readonly restrict buffer scratch_paths { PathEnd ends[]; };
layout(std430) writeonly restrict buffer scratch_baked { vec4 baked[]; };
uniform float inside;

void project(int slot, int point, int row) {
  vec4 sums[COEFFICIENTS];
  for (int j = 0; j < COEFFICIENTS; ++j) sums[j] = vec4(0);
  float here[COEFFICIENTS], there[COEFFICIENTS];
  for (int k = 0; k < paths; ++k) {
    PathEnd end = ends[slot * paths + k];
    if (end.weight.rgb == vec3(0)) continue;
    sh_basis(path_direction(point, k), here);
    sh_basis(end.exit.xyz, there);
    vec4 weight = here[row] * (end.weight.w == 0. ? vec4(0, 0, 0, 1) : vec4(end.weight.rgb, 0));
    for (int j = 0; j < COEFFICIENTS; ++j) sums[j] += weight * there[j];
  }
  for (int j = 0; j < COEFFICIENTS; ++j) {
    baked[matrix_of(point) + row * COEFFICIENTS + j] = sums[j] * (4. * pi / float(paths));
  }
}

// The mean over a lobe cosᵏ as wide as a texel, 2π/(k+1) = 4π/R². What the back of a face hides is at distance 0.
void distances(int slot, int point, int texel) {
  vec3 towards = octahedral_decode(2. * (vec2(texel % moments, texel / moments) + .5) / float(moments) - 1.);
  float exponent = max(1., .5 * float(moments * moments) - 1.), weights = 0.;
  vec2 sum = vec2(0);
  int backs = 0;
  for (int k = 0; k < paths; ++k) {
    float d = ends[slot * paths + k].exit.w;
    if (d < 0.) ++backs;
    float weight = pow(max(0., dot(path_direction(point, k), towards)), exponent);
    d = d == 0. ? grid_reach : clamp(d, 0., grid_reach);
    sum += weight * vec2(d, d * d);
    weights += weight;
  }
  vec2 mean = weights > 1e-6 ? sum / weights : vec2(grid_reach, grid_reach * grid_reach);
  baked[moments_of(point) + texel] = vec4(mean, 0, 0);
  if (texel == 0) baked[state_of(point)] = vec4(0, 0, 0, float(backs) > inside * float(paths) ? 0. : 1.);
}

void main() {
  int task = int(gl_GlobalInvocationID.x), slot = int(gl_GlobalInvocationID.y), point = first_point + slot;
  if (slot >= batch_size || point >= point_count() || state_of(point) >= baked.length()) return;
  if ((slot + 1) * paths > ends.length()) return;
  if (task < COEFFICIENTS) {
    project(slot, point, task);
  } else if (task < COEFFICIENTS + moments * moments) {
    distances(slot, point, task - COEFFICIENTS);
  }
}
