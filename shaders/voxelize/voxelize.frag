// One column of cells under one triangle: the triangle is cut to each cell that it crosses, and what is left adds its
// area, its normal, its place and its material to the sheet of its dominant axis. Areas are exact: summed over all cells
// they are the triangle's own.
#include "lib/axes.glsl"
#include "lib/material.glsl"
#include "voxelize/piece.glsl"
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

void add(ivec3 cell, int row, float value) {
  int amount = int(round(value * FIXED));
  if (amount != 0) atomicAdd(sums[sum_index(cell, axis, row)], amount);
}

void add3(ivec3 cell, int row, vec3 value) {
  for (int i = 0; i < 3; ++i) add(cell, row + i, value[i]);
}

struct Surfel {
  float area;     // in cell faces
  vec3 normal;    // unit, turned to the positive side of the dominant axis
  vec3 position;  // from the cell's centre, in cells
  vec3 albedo, emission;
  bool front_positive, double_sided;
};

void add_surfel(ivec3 cell, Surfel s) {
  add(cell, ROW_AREA, s.area);
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

// The box around a piece of the triangle, outwards to 1/255 of the cell.
void add_box(ivec3 cell, vec3 low, vec3 high) {
  low = turn_axis_back(ceil(255. * clamp(1. - low, 0., 1.)), axis);
  high = turn_axis_back(ceil(255. * clamp(high, 0., 1.)), axis);
  for (int i = 0; i < 3; ++i) {
    atomicMax(sums[sum_index(cell, axis, ROW_BOX + i)], int(low[i]));
    atomicMax(sums[sum_index(cell, axis, ROW_BOX + 3 + i)], int(high[i]));
  }
}

void main() {
  Surfel surfel;
  surfel.albedo = clamp(surface_albedo(), 0., 1.);
#if EMISSION
  surfel.emission = emitted_radiance();
#endif
  float share = opaque_share();
  if (share <= 0.) return;
  vec3 normal = normalize_or(cross(corner_b - corner_a, corner_c - corner_a), vec3(0, 0, 1));
  surfel.front_positive = (normal.z > 0.) != has_flag(SCENE_MIRRORED);
  surfel.double_sided = has_flag(MATERIAL_DOUBLE_SIDED);
  surfel.normal = turn_axis_back(normal.z > 0. ? normal : -normal, axis);

  // From here on in cells from the corner of the column.
  vec3 column = vec3(floor(gl_FragCoord.xy), 0);
  vec3 a = corner_a - column, b = corner_b - column, c = corner_c - column;
  vec3 whole = square_moments(a.xy, b.xy, c.xy);
  float sign_of_turn = normal.z > 0. ? -1. : 1.;
  vec2 slope = -normal.xy / normal.z;
  int depth = int(turn_axis_last(vec3(grid.cells.xyz), axis).z);
  // Heights over the column; a cell owns its lower faces. The slope is at most 45° in u and v.
  float middle = a.z + dot(slope, .5 - a.xy), reach = .5 * (abs(slope.x) + abs(slope.y));
  float low = max(min(a.z, min(b.z, c.z)), middle - reach), high = min(max(a.z, max(b.z, c.z)), middle + reach);
  int first = clamp(int(floor(low)), 0, depth - 1);
  int last = clamp(max(first, int(ceil(high)) - 1), first, min(first + 3, depth - 1));
  vec3 below = vec3(0);
  for (int k = first; k <= last; ++k) {
    vec3 up_to = k == last ? whole : moments_below(a, b, c, float(k + 1), whole);
    vec3 moments = sign_of_turn * (up_to - below);
    below = up_to;
    surfel.area = share * moments.x / abs(normal.z);
    if (!(surfel.area * FIXED >= .5)) continue;
    vec3 place = vec3(moments.yz / moments.x, 0);
    place.z = a.z + dot(slope, place.xy - a.xy);
    ivec3 cell = turn_axis_back(ivec3(column.xy, k), axis);
    surfel.position = turn_axis_back(clamp(place - vec3(0, 0, k), 0., 1.) - .5, axis);
    add_surfel(cell, surfel);
    vec3 piece_low, piece_high;
    bound_piece(a, b, c, slope, float(k), piece_low, piece_high);
    add_box(cell, piece_low - vec3(0, 0, k), piece_high - vec3(0, 0, k));
  }
}
