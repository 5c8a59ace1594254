// Irradiance from a uniform Lambertian polygon in closed form, horizon included.
#ifndef LOOM_LIB_POLYGON_GLSL
#define LOOM_LIB_POLYGON_GLSL
#include "lib/math.glsl"

// Angle between two vectors times the unit normal of the plane that they span: Θ·Γ of Lambert's formula. Written with
// atan(|a×b|, a·b), exact to rounding at any angle, where acos loses half the digits of a small one.
vec3 edge_angle(vec3 a, vec3 b) {
  vec3 c = cross(a, b);
  float s = length(c);
  return s > 0. ? c * (atan(s, dot(a, b)) / s) : vec3(0);
}

// A triangle cut by the horizon plane through the receiver: three or four corners, relative to the receiver.
struct HorizonPolygon {
  vec3 corner[4];
  int count;
};

// The part of the triangle a, b, c (relative to the receiver) above the plane with unit normal n.
HorizonPolygon clip_to_horizon(vec3 a, vec3 b, vec3 c, vec3 n) {
  vec3 corner[3] = vec3[3](a, b, c);
  HorizonPolygon polygon;
  polygon.count = 0;
  for (int i = 0; i < 3; ++i) {
    vec3 p = corner[i], q = corner[(i + 1) % 3];
    float hp = dot(p, n), hq = dot(q, n);
    if (hp >= 0. && polygon.count < 4) polygon.corner[polygon.count++] = p;
    if ((hp > 0. && hq < 0.) || (hp < 0. && hq > 0.)) {
      if (polygon.count < 4) polygon.corner[polygon.count++] = mix(p, q, hp / (hp - hq));
    }
  }
  return polygon;
}

// Irradiance at the origin on a plane with unit normal n from a polygon of radiance 1 (above the horizon, either
// orientation): E = ½ |Σ Θ_i ⟨Γ_i, n⟩|. Lambert, Photometria (1760); Baum et al. 1989, eq. 10.
float polygon_irradiance(HorizonPolygon polygon, vec3 n) {
  vec3 sum = vec3(0);
  for (int i = 0; i < polygon.count; ++i) {
    sum += edge_angle(polygon.corner[i], polygon.corner[i + 1 < polygon.count ? i + 1 : 0]);
  }
  return .5 * abs(dot(sum, n));
}

// A point inside the polygon: the mean of its corners.
vec3 polygon_middle(HorizonPolygon polygon) {
  vec3 sum = vec3(0);
  for (int i = 0; i < polygon.count; ++i) sum += polygon.corner[i];
  return sum / float(max(polygon.count, 1));
}
#endif
