// One point of a surface a texel: FROM says how it is found (passes/surface_points/surface_points.cpp).
#include "interop/frame.h"
#include "lib/sampling.glsl"
#include "lib/trace.glsl"
#if LIT
#include "lib/punctual_light.glsl"
#endif
layout(local_size_x = 8, local_size_y = 4) in;

#define FROM_area 0
#define FROM_vertices 1
#define FROM_sides 2
#define FROM_cube 3

layout(std140) uniform frame_data { FrameData frame; };
#if FROM == FROM_area
layout(std430) readonly buffer scratch_areas { float areas[]; };
#endif
#if MAKE_position
layout(rgba32f) uniform writeonly image2DArray points_position;
#endif
#if MAKE_normal
layout(rgba16f) uniform writeonly image2DArray points_normal;
#endif
#if MAKE_albedo
writeonly uniform image2DArray points_albedo;
#endif
#if MAKE_flux
writeonly uniform image2DArray points_flux;
#endif
uniform int side;  // of the image, texels
uniform vec3 box_low, box_high;  // of the scene
uniform vec3 eye;                // of the cubemap

struct Point {
  vec3 position, normal, albedo;
  float area;  // m²; 0: none
  float sides;  // that the point stands for
};

#if FROM == FROM_area || FROM == FROM_vertices
Point on_triangle(int triangle, vec2 barycentrics, float area, int index) {
  Hit hit = Hit(0., uint(triangle), barycentrics);
  float sides = 1.;
  vec3 n = hit_normal(hit);
#if LIT
  sides = 2.;
  if ((index & 1) == 1) n = -n;
#endif
  return Point(hit_position(hit), n, hit_albedo(hit), opaque_at(hit.triangle, barycentrics) ? area : 0., sides);
}
#endif

#if FROM == FROM_area
// The triangle that holds the share of all area, and in it a point of a sequence that is even over neighbours too.
Point take(ivec3 texel) {
  int index = texel.x + side * texel.y, count = side * side, last = bvh_triangles.length() - 1;
  float at = areas[last] * ((float(index) + .5) / float(count));
  int low = 0, high = last;
  while (low < high) {
    int middle = (low + high) / 2;
    if (at < areas[middle]) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  vec2 w = uniform_triangle(low_discrepancy(uint(index), hash(uvec4(frame.random.x, 0x61726561u, 0u, 0u)).x));
  return on_triangle(low, w, areas[last] / float(count), index);
}
#elif FROM == FROM_vertices
Point take(ivec3 texel) {
  int index = texel.x + side * texel.y, triangle = index / 3;
  if (triangle >= bvh_triangles.length()) return Point(vec3(0), vec3(0), vec3(0), 0., 1.);
  vec3 a = bvh_triangles[triangle].a.xyz;
  float area = .5 * length(cross(bvh_triangles[triangle].b.xyz - a, bvh_triangles[triangle].c.xyz - a));
  int corner = index - 3 * triangle;
  return on_triangle(triangle, vec2(corner == 1, corner == 2), area / 3., index);
}
#else
// Two views of an axis follow each other, along it and against it.
Point take(ivec3 texel) {
  int axis = texel.z / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  vec2 q = (2. * vec2(texel.xy) + 1.) / float(side) - 1.;
  vec3 direction = vec3(0);
  direction[axis] = (texel.z & 1) == 0 ? 1. : -1.;
#if FROM == FROM_sides
  vec3 middle = .5 * (box_low + box_high), half_box = .5 * (box_high - box_low), origin = middle;
  // From a little outside: a wall in the side itself is seen too.
  origin[axis] -= direction[axis] * (half_box[axis] + 1e-3 * length(half_box));
  origin[u] += q.x * half_box[u];
  origin[v] += q.y * half_box[v];
  float spread = 4. * half_box[u] * half_box[v] / float(side * side), least_cosine = 1e-6;
#else
  vec3 origin = eye;
  direction[u] = q.x;
  direction[v] = q.y;
  float square = dot(direction, direction);
  direction *= inversesqrt(square);
  float spread = 4. / (float(side * side) * square * sqrt(square));
  float least_cosine = .5 * sqrt(spread);  // within a texel, the angle changes by as much
#endif
  Hit hit = closest_hit(origin, direction, no_hit);
  if (!is_hit(hit)) return Point(vec3(0), vec3(0), vec3(0), 0., 1.);
  vec3 n = hit_normal(hit);
  float cosine = -dot(n, direction);
  if (cosine < 0.) n = -n;
#if FROM == FROM_cube
  spread *= hit.t * hit.t;
#endif
  return Point(hit_position(hit), n, hit_albedo(hit), spread / max(abs(cosine), least_cosine), 1.);
}
#endif

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (texel.x >= side || texel.y >= side) return;
  Point p = take(texel);
#if MAKE_position
  imageStore(points_position, texel, vec4(p.position, p.area));
#endif
#if MAKE_normal
  imageStore(points_normal, texel, vec4(p.normal, 0));
#endif
#if MAKE_albedo
  imageStore(points_albedo, texel, vec4(p.albedo, 1));
#endif
#if MAKE_flux
  vec3 irradiance = p.area > 0. ? punctual_irradiance(p.position, p.normal, p.normal) : vec3(0);
  imageStore(points_flux, texel, vec4(p.albedo * irradiance * (p.sides * p.area), 1));
#endif
}
