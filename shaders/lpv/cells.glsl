// The propagation state: intensity I(ω) of each cell as two-band SH, one vec4 a channel. `front` has two halves, the
// one being read and the one being written; the fourth vector of a cell holds the flux-keeping factors of its channels.
#include "interop/grid.h"
#include "lib/grid.glsl"
#include "lib/sh.glsl"

layout(std140) uniform flux_data { Grid grid; };
layout(std430) buffer scratch_front { vec4 front[]; };     // [2][4][cells]
layout(std430) buffer scratch_sum { vec4 sum[]; };         // [3][cells] all light that has passed through a cell
layout(std430) buffer scratch_blocked { vec4 blocked[]; }; // [3][cells] reflected at surfaces: source of the next order

int cell_count() { return grid.cells.x * grid.cells.y * grid.cells.z; }

// Solid angles of a neighbour's faces, seen from the centre of a cell of size 1: the front face at distance 1.5, a
// side face. One front and four sides make up the cell face in between: 4π/6.
const float FRONT_SOLID_ANGLE = 0.4006696847;
const float SIDE_SOLID_ANGLE = 0.4234313544;

// The six axis directions.
vec3 axis_direction(int i) {
  vec3 d = vec3(0);
  d[i >> 1] = (i & 1) == 0 ? 1.0 : -1.0;
  return d;
}

// From a cell's centre to the centre of face `f` of the neighbour in direction `d`.
vec3 to_face(vec3 d, vec3 f) { return normalize(d + 0.5 * f); }

float face_solid_angle(vec3 d, vec3 f) { return dot(d, f) > 0.5 ? FRONT_SOLID_ANGLE : SIDE_SOLID_ANGLE; }

// Two bands ring below zero. Clamping alone would add energy (13.8 % for a cosine lobe), so that what is sent is scaled
// back to the unclamped total: this factor. The unclamped total over all 30 faces is 4π·Y00·c00, since Y1 cancels.
float flux_keeping_factor(vec4 c) {
  float total = 12.5663706 * SH_Y0 * c.x;
  float clamped = 0.0;
  for (int i = 0; i < 6; ++i) {
    vec3 d = axis_direction(i);
    for (int j = 0; j < 6; ++j) {
      vec3 f = axis_direction(j);
      if (dot(d, f) < -0.5) continue;
      clamped += max(0.0, dot(c, sh2_basis(to_face(d, f)))) * face_solid_angle(d, f);
    }
  }
  return clamped > 0.0 ? max(0.0, total) / clamped : 0.0;
}
