// What the lattice's points hold, vec4s one behind the other: the transfer matrix [i][j] (rgb: reflected, a: straight), the
// moments of the distance by direction (xy), and the state (w: 1 on, 0 off).
#include "interop/probes.h"
#include "lib/math.glsl"

// As ProbeGrid.
uniform int counts_x, counts_y, counts_z;
uniform vec3 grid_lower;
uniform vec3 grid_spacing;
uniform float grid_reach;  // distances are cut off here
uniform int moments;       // side of the map

int point_count() { return counts_x * counts_y * counts_z; }
ivec3 point_at(int p) {
  return ivec3(p % counts_x, p / counts_x % counts_y, p / (counts_x * counts_y));
}
vec3 point_position(int p) { return grid_lower + vec3(point_at(p)) * grid_spacing; }
int matrix_of(int p) { return p * (COEFFICIENTS * COEFFICIENTS + moments * moments + 1); }
int moments_of(int p) { return matrix_of(p) + COEFFICIENTS * COEFFICIENTS; }
int state_of(int p) { return moments_of(p) + moments * moments; }
