// Area of all triangles up to each: cumulative sums, by one work group, in a fixed order.
#include "interop/scene.h"
layout(local_size_x = 256) in;

layout(std430) readonly restrict buffer scene_bvh_triangles { BvhTriangle bvh_triangles[]; };
layout(std430) buffer scratch_areas { float areas[]; };
shared float before[256];

float triangle_area(int i) {
  vec3 a = bvh_triangles[i].a.xyz;
  return 0.5 * length(cross(bvh_triangles[i].b.xyz - a, bvh_triangles[i].c.xyz - a));
}

void main() {
  int self = int(gl_LocalInvocationID.x), count = bvh_triangles.length();
  int share = (count + 255) / 256, first = self * share, end = min(first + share, count);
  float sum = 0.0;
  for (int i = first; i < end; ++i) sum += triangle_area(i);
  before[self] = sum;
  barrier();
  float start = 0.0;
  for (int i = 0; i < self; ++i) start += before[i];
  for (int i = first; i < end; ++i) {
    start += triangle_area(i);
    areas[i] = start;
  }
}
