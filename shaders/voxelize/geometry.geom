// Cuts the triangle into the slices of its axis and draws each part into its own. INVOCATIONS runs of this stage share
// the slices of one triangle, four at most to each.
#include "voxelize/project.glsl"
layout(invocations = INVOCATIONS) in;
layout(triangle_strip, max_vertices = 24) out;
flat out int slice;

vec3 corner_weights(int i) { return vec3(equal(ivec3(i), ivec3(0, 1, 2))); }

// Barycentric weights where the edge from corner i up to corner j passes a height; on a level edge those of `share`.
vec3 weights_on_edge(Projected t, int i, int j, float height, float share) {
  float rise = t.corner[j].z - t.corner[i].z;
  if (rise > 0.) share = clamp((height - t.corner[i].z) / rise, 0., 1.);
  return mix(corner_weights(i), corner_weights(j), share);
}

void emit_weights(Projected t, vec3 w) { emit_corner(t, (mat3(t.corner[0], t.corner[1], t.corner[2]) * w).xy, w); }

void main() {
  Projected t;
  if (!project(t)) return;
  vec3 height = vec3(t.corner[0].z, t.corner[1].z, t.corner[2].z);
  int lowest = height.x <= height.y && height.x <= height.z ? 0 : height.y <= height.z ? 1 : 2;
  int highest = height.z >= height.x && height.z >= height.y ? 2 : height.y >= height.x ? 1 : 0;
  if (highest == lowest) highest = (lowest + 1) % 3;
  int middle = 3 - lowest - highest;
  int depth = int(turn_axis_last(vec3(grid.cells.xyz), t.axis).z);
  int first = max(0, int(floor(height[lowest]))), last = min(depth - 1, int(floor(height[highest])));
  for (int k = first + gl_InvocationID; k <= last; k += INVOCATIONS) {
    // At any height the triangle reaches from its longest edge to the two others: a strip between three heights.
    float low = max(float(k), height[lowest]), high = min(float(k + 1), height[highest]);
    for (int i = 0; i < 3; ++i) {
      float at = i == 0 ? low : i == 1 ? clamp(height[middle], low, high) : high;
      slice = k;
      emit_weights(t, weights_on_edge(t, lowest, highest, at, .5 * float(i)));
      slice = k;
      emit_weights(t, at < height[middle] ? weights_on_edge(t, lowest, middle, at, 0.)
                                          : weights_on_edge(t, middle, highest, at, i == 2 ? 1. : 0.));
    }
    EndPrimitive();
  }
}
