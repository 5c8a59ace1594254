// What a fragment adds to the sheet of its triangle's axis, whatever the way in which it was cut to its cell.
#ifndef LOOM_VOXELIZE_SURFEL_GLSL
#define LOOM_VOXELIZE_SURFEL_GLSL
#include "lib/axes.glsl"
#include "lib/material.glsl"
#include "voxelize/sums.glsl"

flat in vec3 corner_a;
flat in vec3 corner_b;
flat in vec3 corner_c;
flat in int axis;
#if EMISSION
uniform float inverse_max_emission;
#endif

// A back of a single-sided surface is seen where nothing else is: behind a front it weighs next to nothing. So the mean
// of a thin wall's outer side is not that of its inside.
const float BACK_WEIGHT = 1. / 256.;

// Share of the column that a mask leaves, of 4×4 points.
float opaque_share() {
#if defined(SCENE_ALPHA_MASK) && defined(SCENE_TEXTURES)
  if (!has_flag(MATERIAL_MASK)) return 1.;
  float alpha = materials[vertex.ids.x].base_color.a * vertex.color.a;
  if (!has_flag(MATERIAL_BASE_COLOR_TEXTURE)) return alpha >= materials[vertex.ids.x].emissive.w ? 1. : 0.;
  vec2 across = dFdx(vertex.base_color_uv), up = dFdy(vertex.base_color_uv);
  int opaque = 0;
  for (int i = 0; i < 16; ++i) {
    vec2 offset = vec2(i & 3, i >> 2) * .25 - .375;
    float a = alpha * textureLod(material_base_color, vertex.base_color_uv + offset.x * across + offset.y * up, 0.).a;
    opaque += int(a >= materials[vertex.ids.x].emissive.w);
  }
  return float(opaque) / 16.;
#else
  return surface_visible() ? 1. : 0.;
#endif
}

// The triangle over the fragment's column of cells: in cells from its corner, the dominant axis last.
struct Column {
  vec3 a, b, c;
  vec3 normal;  // unit
  vec2 slope;   // of the height over (u, v), at most 45° each
  vec2 corner;  // of the column, in cells
  int depth;    // of the grid along the axis
};

Column column_of_fragment() {
  Column column;
  column.corner = floor(gl_FragCoord.xy);
  column.a = corner_a - vec3(column.corner, 0);
  column.b = corner_b - vec3(column.corner, 0);
  column.c = corner_c - vec3(column.corner, 0);
  column.normal = normalize_or(cross(corner_b - corner_a, corner_c - corner_a), vec3(0, 0, 1));
  column.slope = -column.normal.xy / column.normal.z;
  column.depth = int(turn_axis_last(vec3(grid.cells.xyz), axis).z);
  return column;
}

float height_at(Column column, vec2 at) { return column.a.z + dot(column.slope, at - column.a.xy); }

struct Surfel {
  float area;     // in cell faces
  vec3 normal;    // unit, turned to the positive side of the dominant axis
  vec3 position;  // from the cell's centre, in cells
  vec3 albedo, emission;
  bool front_positive, double_sided;
};

// The fragment's material; area and position are still to come.
Surfel surfel_of_fragment(Column column) {
  Surfel surfel;
  surfel.albedo = clamp(surface_albedo(), 0., 1.);
#if EMISSION
  surfel.emission = emitted_radiance();
#endif
  surfel.front_positive = (column.normal.z > 0.) != has_flag(SCENE_MIRRORED);
  surfel.double_sided = has_flag(MATERIAL_DOUBLE_SIDED);
  surfel.normal = turn_axis_back(column.normal.z > 0. ? column.normal : -column.normal, axis);
  return surfel;
}

void add(ivec3 cell, int row, float value) {
  int amount = int(round(value * FIXED));
  if (amount != 0) atomicAdd(sums[sum_index(cell, axis, row)], amount);
}

void add3(ivec3 cell, int row, vec3 value) {
  for (int i = 0; i < 3; ++i) add(cell, row + i, value[i]);
}

// The box around a piece of the triangle, outwards to 1/255 of the cell.
void add_box(ivec3 cell, vec3 low, vec3 high) {
  low = turn_axis_back(ceil(255. * clamp(1. - low, 0., 1.)), axis);
  high = turn_axis_back(ceil(255. * clamp(high, 0., 1.)), axis);
  for (int i = 0; i < 3; ++i) {
    atomicMax(sums[sum_index(cell, axis, ROW_BOX + i)], int(low[i]));
    atomicMax(sums[sum_index(cell, axis, ROW_BOX + 3 + i)], int(high[i]));
  }
}

void add_surfel(ivec3 cell, Surfel s) {
  add(cell, ROW_AREA, s.area);
  if (COMBINE == COMBINE_MAX) atomicMax(sums[sum_index(cell, axis, ROW_LARGEST)], int(round(s.area * FIXED)));
  add3(cell, ROW_NORMAL, s.area * s.normal);
  add3(cell, ROW_POSITION, s.area * s.position);
  for (int side = 0; side < 2; ++side) {
    bool front = s.double_sided || s.front_positive == (side == 0);
    float weight = front ? s.area : s.area * BACK_WEIGHT;
    int row = ROW_SIDE + side * SIDE_ROWS;
    add(cell, row, weight);
    add3(cell, row + 1, weight * s.position);
    add3(cell, row + 4, weight * s.albedo);
#if EMISSION
    if (front) add3(cell, ROW_EMISSION + 3 * side, weight * inverse_max_emission * s.emission);
#endif
  }
}

// A piece of the triangle in slice k of the column: its area in cell faces, a point of it (the centroid) and its box, from
// the lower corner of the cell.
void add_piece(Column column, int k, inout Surfel surfel, float area, vec3 middle, vec3 low, vec3 high) {
  ivec3 cell = turn_axis_back(ivec3(column.corner, k), axis);
  surfel.area = area;
  surfel.position = turn_axis_back(clamp(middle, 0., 1.) - .5, axis);
  add_surfel(cell, surfel);
  add_box(cell, low, high);
}
#endif
