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

#ifdef DIRECTIONAL
// Sums of blockers, [slot][cell], in 64 bits: a surface element can be anything from a millionth of a face to all of it.
// Slots of axis e: area, then area × albedo of each channel; after those of the three axes the shares by direction.
const int AXIS_SLOTS = 1 + CHANNELS, DIRECTION_SLOT = 3 * AXIS_SLOTS;
const float SHARE = 268435456.0;  // units of a whole face, 2²⁸
layout(std430) buffer scratch_low { uint low_words[]; };
layout(std430) buffer scratch_high { uint high_words[]; };

void add_sum(int slot, int cell, float share) {
  int value = int(round(share * SHARE));
  if (value == 0) return;
  int at = slot * cell_count() + cell;
  uint low = uint(value), before = atomicAdd(low_words[at], low);
  int high = (value < 0 ? -1 : 0) + (before + low < before ? 1 : 0);
  if (high != 0) atomicAdd(high_words[at], uint(high));
}

// A sum in faces.
float read_sum(int slot, int cell) {
  int at = slot * cell_count() + cell;
  int low = int(low_words[at]), high = int(high_words[at]) + (low < 0 ? 1 : 0);
  return (float(high) * 4294967296.0 + float(low)) / SHARE;
}

// A surface element blocks the cell face nearest to it along each axis e, by A·|<n,e>|/s² of it, kept with the cell whose
// lower face that is. By direction of travel ω it blocks B(ω) = A/s²·⟨n,−ω⟩₊ at the nearest corner of cells, kept with the
// cell whose lower corner that is. No element covers more than one face.
void add_blocker(vec3 position, vec3 normal, float surfel_area, vec3 albedo) {
  float faces = surfel_area / (grid.cascade[cascade].w * grid.cascade[cascade].w);
  vec3 w = grid_coordinates(grid, cascade, position);
  for (int axis = 0; axis < 3; ++axis) {
    vec3 at = w;
    at[axis] += 0.5;  // nearest face: round along the axis, floor along the others
    if (!(all(greaterThanEqual(at, vec3(0))) && all(lessThan(at, vec3(grid.cells.xyz))))) continue;
    int k = grid_index(grid, ivec3(floor(at)));
    float share = min(1.0, faces * abs(normal[axis]));
    add_sum(AXIS_SLOTS * axis, k, share);
    for (int channel = 0; channel < CHANNELS; ++channel) {
      add_sum(AXIS_SLOTS * axis + 1 + channel, k, share * clamp(albedo[channel], 0.0, 1.0));
    }
  }
#if DIRECTIONAL
  vec3 corner = w + 0.5;
  if (!(all(greaterThanEqual(corner, vec3(0))) && all(lessThan(corner, vec3(grid.cells.xyz))))) return;
  vec4 lobe = min(1.0, faces) * sh2_cosine_lobe(-normal);
  for (int i = 0; i < 4; ++i) add_sum(DIRECTION_SLOT + i, grid_index(grid, ivec3(floor(corner))), lobe[i]);
#endif
}
#endif
