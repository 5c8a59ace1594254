// One column of cells under one triangle: the triangle is cut to each cell that it crosses, and what is left adds its
// area, its normal, its place and its material to the sheet of its dominant axis. Areas are exact: summed over all cells
// they are the triangle's own.
#include "voxelize/piece.glsl"
#include "voxelize/surfel.glsl"

void main() {
  Column column = column_of_fragment();
  Surfel surfel = surfel_of_fragment(column);
  float share = opaque_share();
  if (share <= 0.) return;
  vec3 a = column.a, b = column.b, c = column.c;
  vec3 whole = square_moments(a.xy, b.xy, c.xy);
  float sign_of_turn = column.normal.z > 0. ? -1. : 1.;
  // Heights over the column; a cell owns its lower faces.
  float middle = height_at(column, vec2(.5)), reach = .5 * (abs(column.slope.x) + abs(column.slope.y));
  float low = max(min(a.z, min(b.z, c.z)), middle - reach), high = min(max(a.z, max(b.z, c.z)), middle + reach);
  int first = clamp(int(floor(low)), 0, column.depth - 1);
  int last = clamp(max(first, int(ceil(high)) - 1), first, min(first + 3, column.depth - 1));
  vec3 below = vec3(0);
  for (int k = first; k <= last; ++k) {
    vec3 up_to = k == last ? whole : moments_below(a, b, c, float(k + 1), whole);
    vec3 moments = sign_of_turn * (up_to - below);
    below = up_to;
    float area = share * moments.x / abs(column.normal.z);
    // Under one unit along the dominant axis the normal would round to nothing, and the sheet would have an area without
    // a plane.
    if (!(share * moments.x * FIXED >= 1.)) continue;
    vec2 place = moments.yz / moments.x;
    vec3 piece_low, piece_high, floor_of_cell = vec3(0, 0, k);
    bound_piece(a, b, c, column.slope, float(k), piece_low, piece_high);
    add_piece(column, k, surfel, area, vec3(place, height_at(column, place)) - floor_of_cell,
              piece_low - floor_of_cell, piece_high - floor_of_cell);
  }
}
