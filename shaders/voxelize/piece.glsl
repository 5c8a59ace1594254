// The part of a triangle inside a cell, in closed form: area, centroid and bounds without ever building its polygon,
// whose dynamically indexed corners cost more than everything else in a fragment. Coordinates are (u, v, w) from the lower
// corner of the column of cells, in cells; the triangle is a function w(u, v).
#ifndef LOOM_VOXELIZE_PIECE_GLSL
#define LOOM_VOXELIZE_PIECE_GLSL

// ∫ v du, ∫ u·v du and ∫ ½v² du under a line from (x, a) to (y, b).
vec3 trapezoid(float x, float a, float y, float b) {
  return (y - x) * vec3(.5 * (a + b), (x * (2. * a + b) + y * (a + 2. * b)) / 6., (a * a + a * b + b * b) / 6.);
}

// The same under the edge p → q of a polygon, as far as it lies over the unit square: u is cut to [0, 1], v clamped.
vec3 edge_moments(vec2 p, vec2 q) {
  float x = clamp(p.x, 0., 1.), y = clamp(q.x, 0., 1.);
  if (x == y) return vec3(0);
  float slope = (q.y - p.y) / (q.x - p.x);
  float a = p.y + slope * (x - p.x), b = p.y + slope * (y - p.x);
  // Where the line enters and leaves 0 ≤ v ≤ 1, as shares of the way from x to y.
  float rise = abs(b - a) > 1e-12 ? 1. / (b - a) : 0.;
  float t0 = clamp(-a * rise, 0., 1.), t1 = clamp((1. - a) * rise, 0., 1.);
  if (rise == 0.) {
    t0 = 0.;
    t1 = 1.;
  }
  float enter = mix(x, y, min(t0, t1)), leave = mix(x, y, max(t0, t1));
  float low = clamp(a, 0., 1.), high = clamp(b, 0., 1.);
  return trapezoid(x, low, enter, low) + trapezoid(enter, low, leave, high) + trapezoid(leave, high, y, high);
}

// Area and first moments (∫∫ 1, ∫∫ u, ∫∫ v) of a triangle's projection within the unit square, by Green's theorem;
// positive where a, b, c run clockwise.
vec3 square_moments(vec2 a, vec2 b, vec2 c) { return edge_moments(a, b) + edge_moments(b, c) + edge_moments(c, a); }

// The same for the part with w ≤ height; `whole`: of all of it. A plane cuts off one corner, and what is below is either
// that corner or the rest.
vec3 moments_below(vec3 a, vec3 b, vec3 c, float height, vec3 whole) {
  bvec3 below = lessThanEqual(vec3(a.z, b.z, c.z), vec3(height));
  int count = int(below.x) + int(below.y) + int(below.z);
  if (count == 0) return vec3(0);
  if (count == 3) return whole;
  // The lone corner first, the others in their order.
  bool rest = count == 2;
  vec3 lone = below.x != rest ? a : below.y != rest ? b : c;
  vec3 next = below.x != rest ? b : below.y != rest ? c : a;
  vec3 last = below.x != rest ? c : below.y != rest ? a : b;
  vec2 p = mix(lone, next, (height - lone.z) / (next.z - lone.z)).xy;
  vec2 q = mix(lone, last, (height - lone.z) / (last.z - lone.z)).xy;
  vec3 corner = square_moments(lone.xy, p, q);
  return rest ? whole - corner : corner;
}

// Bounds of the part of the segment p → q inside the box 0 ≤ u, v ≤ 1, k ≤ w ≤ k+1 (Liang and Barsky 1984).
void bound_segment(vec3 p, vec3 q, float k, inout vec3 low, inout vec3 high) {
  float t0 = 0., t1 = 1.;
  vec3 d = q - p;
  for (int i = 0; i < 3; ++i) {
    float from = i == 2 ? k : 0.;
    if (abs(d[i]) < 1e-12) {
      if (p[i] < from || p[i] > from + 1.) return;
    } else {
      float a = (from - p[i]) / d[i], b = (from + 1. - p[i]) / d[i];
      t0 = max(t0, min(a, b));
      t1 = min(t1, max(a, b));
    }
  }
  if (t0 > t1) return;
  low = min(low, min(p + t0 * d, p + t1 * d));
  high = max(high, max(p + t0 * d, p + t1 * d));
}

// True where (u, v) lies over the triangle.
bool over_triangle(vec2 a, vec2 b, vec2 c, vec2 p) {
  vec3 side = vec3((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x),
                   (c.x - b.x) * (p.y - b.y) - (c.y - b.y) * (p.x - b.x),
                   (a.x - c.x) * (p.y - c.y) - (a.y - c.y) * (p.x - c.x));
  return all(greaterThanEqual(side, vec3(0))) || all(lessThanEqual(side, vec3(0)));
}

// Bounds of the part of the triangle in the cell: its corners are on the triangle's edges, where they are inside, and on
// the cell's edges, where they meet the triangle. `slope`: of w over (u, v).
void bound_piece(vec3 a, vec3 b, vec3 c, vec2 slope, float k, out vec3 low, out vec3 high) {
  low = vec3(1, 1, k + 1.);
  high = vec3(0, 0, k);
  bound_segment(a, b, k, low, high);
  bound_segment(b, c, k, low, high);
  bound_segment(c, a, k, low, high);
  for (int i = 0; i < 12; ++i) {
    vec2 side = vec2(i & 1, (i >> 1) & 1);
    vec3 p;
    if (i < 4) {  // edges along w
      p = vec3(side, a.z + dot(slope, side - a.xy));
    } else {  // along u or v, at the floor or the ceiling of the cell
      bool along_u = i < 8;
      float height = k + side.y - a.z, rise = along_u ? slope.x : slope.y;
      if (rise == 0.) continue;
      p = along_u ? vec3(a.x + (height - slope.y * (side.x - a.y)) / rise, side.x, k + side.y)
                  : vec3(side.x, a.y + (height - slope.x * (side.x - a.x)) / rise, k + side.y);
    }
    bool inside = all(greaterThanEqual(p, vec3(0, 0, k))) && all(lessThanEqual(p, vec3(1, 1, k + 1.)));
    if (!inside || !over_triangle(a.xy, b.xy, c.xy, p.xy)) continue;
    low = min(low, p);
    high = max(high, p);
  }
}
#endif
