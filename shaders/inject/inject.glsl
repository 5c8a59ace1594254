// Fixed-point accumulation: integer atomics are order-independent, so that the same frame twice is bit-identical.
// One cascade at a time: the sums hold the cells of that one.
#include "interop/grid.h"
#include "lib/grid.glsl"
#include "lib/sh.glsl"

layout(std140) uniform flux_data { Grid grid; };
uniform int cascade;

int cell_count() { return grid.cells.x * grid.cells.y * grid.cells.z; }
// Where a cell of the cascade lies in a volume texture.
ivec3 volume_texel(ivec3 cell) { return cell + ivec3(0, 0, cascade * grid.cells.z); }

#ifdef ADDS_BLOCKERS
// A surface element blocks the cell face nearest to it along each axis e, by A·|<n,e>|/s² of it. Stored with the cell
// whose lower face that is: [axis][area, albedo rgb][cell].
layout(std430) buffer scratch_area { uint area[]; };
#if DIRECTIONAL
// The blocked share by direction of travel ω, B(ω) = A/s²·⟨n,−ω⟩₊, at the nearest corner of cells: [coefficient][cell],
// kept with the cell whose lower corner that is.
layout(std430) buffer scratch_directional { int directional[]; };
#endif

void add_blocker(vec3 position, vec3 normal, float surfel_area, vec3 albedo, float area_scale) {
  float s = grid.cascade[cascade].w;
  vec3 w = grid_coordinates(grid, cascade, position);
  int n = cell_count();
  for (int axis = 0; axis < 3; ++axis) {
    vec3 at = w;
    at[axis] += 0.5;  // nearest face: round along the axis, floor along the others
    if (!(all(greaterThanEqual(at, vec3(0))) && all(lessThan(at, vec3(grid.cells.xyz))))) continue;
    int k = 4 * axis * n + grid_index(grid, ivec3(floor(at)));
    // One element covers at most one face: with area_scale ≤ 2³²/elements the sum cannot wrap.
    float share = min(1.0, surfel_area * abs(normal[axis]) / (s * s));
    uint amount = uint(share * area_scale + 0.5);
    if (amount == 0u) continue;
    atomicAdd(area[k], amount);
    for (int channel = 0; channel < 3; ++channel) {
      atomicAdd(area[k + (1 + channel) * n], uint(share * clamp(albedo[channel], 0.0, 1.0) * area_scale + 0.5));
    }
  }
#if DIRECTIONAL
  vec3 corner = w + 0.5;
  if (!(all(greaterThanEqual(corner, vec3(0))) && all(lessThan(corner, vec3(grid.cells.xyz))))) return;
  int k = grid_index(grid, ivec3(floor(corner)));
  // A quarter of the scale: a sign, and coefficients up to 1.0234.
  vec4 lobe = min(1.0, surfel_area / (s * s)) * sh2_cosine_lobe(-normal) * (0.25 * area_scale);
  for (int i = 0; i < 4; ++i) atomicAdd(directional[i * n + k], int(round(lobe[i])));
#endif
}
#endif
