// Polygons in space, cut by planes across the axes. Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 17(1),
// 1974.
#ifndef LOOM_LIB_CLIP_GLSL
#define LOOM_LIB_CLIP_GLSL

// A triangle cut by six planes has at most nine corners.
const int MAX_CORNERS = 9;
struct Polygon {
  vec3 corner[MAX_CORNERS];
  int count;
};

Polygon polygon_of(vec3 a, vec3 b, vec3 c) {
  Polygon polygon;
  polygon.corner[0] = a;
  polygon.corner[1] = b;
  polygon.corner[2] = c;
  polygon.count = 3;
  return polygon;
}

// The part where side·(p[axis] − bound) ≥ 0.
Polygon clip(Polygon polygon, int axis, float bound, float side) {
  Polygon kept;
  kept.count = 0;
  for (int i = 0; i < polygon.count; ++i) {
    vec3 p = polygon.corner[i], q = polygon.corner[i + 1 < polygon.count ? i + 1 : 0];
    float from = side * (p[axis] - bound), to = side * (q[axis] - bound);
    if (from >= 0. && kept.count < MAX_CORNERS) kept.corner[kept.count++] = p;
    if ((from > 0. && to < 0.) || (from < 0. && to > 0.)) {
      vec3 cut = mix(p, q, from / (from - to));
      cut[axis] = bound;  // exactly, whatever the rounding
      if (kept.count < MAX_CORNERS) kept.corner[kept.count++] = cut;
    }
  }
  return kept;
}

// Area of a flat convex polygon, and its centroid.
float polygon_area(Polygon polygon, out vec3 middle) {
  float area = 0.;
  vec3 moment = vec3(0), a = polygon.corner[0];
  for (int i = 1; i + 1 < polygon.count; ++i) {
    vec3 b = polygon.corner[i] - a, c = polygon.corner[i + 1] - a;
    float part = .5 * length(cross(b, c));
    area += part;
    moment += part * (b + c);
  }
  middle = area > 0. ? a + moment / (3. * area) : a;
  return area;
}
#endif
