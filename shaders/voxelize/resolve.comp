// Sums to means: the sheets of one cell.
#include "lib/axes.glsl"
#include "lib/math.glsl"
#include "voxelize/sums.glsl"
layout(local_size_x = 32) in;

layout(rgba16f) uniform writeonly image3D voxels_coverage;
layout(rgba16f) uniform writeonly image3D voxels_plane;
layout(rgba8) uniform writeonly image3D voxels_extent;
layout(rgba16f) uniform writeonly image3D voxels_centroid;
layout(rgba16f) uniform writeonly image3D voxels_albedo;
#if EMISSION
layout(rgba32f) uniform writeonly image3D voxels_emission;
uniform float max_emission;
#endif

float sum(ivec3 cell, int axis, int row) { return float(sums[sum_index(cell, axis, row)]) / FIXED; }
vec3 sum3(ivec3 cell, int axis, int row) {
  return vec3(sum(cell, axis, row), sum(cell, axis, row + 1), sum(cell, axis, row + 2));
}

// ∫∫ of the step function: the area under x + y ≤ t for x in [−a/2, a/2], y in [−b/2, b/2], as a share of a·b.
float share_below(float t, float a, float b) {
  a = max(a, 1e-3);
  b = max(b, 1e-3);
  vec4 s = max(vec4(t) + .5 * vec4(a + b, a - b, b - a, -a - b), 0.);
  s *= s;
  return clamp(.5 * (s.x - s.y - s.z + s.w) / (a * b), 0., 1.);
}

// Area of the plane ⟨n, p⟩ = offset inside the cell and over the rectangle `extent` (u0, v0, u1, v1), in cell faces.
// n is turned: its largest component last.
float section_area(vec3 n, float offset, vec4 extent) {
  vec2 span = extent.zw - extent.xy, middle = .5 * (extent.xy + extent.zw) - .5;
  // Height over the rectangle: w = (offset − n_u u − n_v v)/n_w, inside where |w| ≤ ½.
  float t = offset - dot(n.xy, middle);
  float a = abs(n.x) * span.x, b = abs(n.y) * span.y;
  return span.x * span.y * (share_below(t + .5 * n.z, a, b) - share_below(t - .5 * n.z, a, b)) / n.z;
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  vec4 coverage = vec4(0);
  for (int axis = 0; axis < 3; ++axis) {
    ivec3 at = cell + ivec3(0, 0, axis * grid.cells.z);
    vec4 plane = vec4(0), extent = vec4(0);
    float area = sum(cell, axis, ROW_AREA);
    if (area > 0.) {
      vec3 mean = sum3(cell, axis, ROW_NORMAL) / area;  // its length is the flatness: 1 where all triangles are parallel
      float flatness = length(mean);
      vec3 n = mean / flatness;
      float offset = dot(n, sum3(cell, axis, ROW_POSITION) / area);
      plane = vec4(mean, offset);
      for (int i = 0; i < 4; ++i) extent[i] = float(clamp(sums[sum_index(cell, axis, ROW_EXTENT + i)], 0, 255)) / 255.;
      extent.xy = 1. - extent.xy;
      float section = section_area(turn_axis_last(n, axis), offset, extent);
      coverage[axis] = area < section ? area / section : 1.;
      coverage.w = 1.;
    }
    imageStore(voxels_plane, at, plane);
    imageStore(voxels_extent, at, extent);
    for (int side = 0; side < 2; ++side) {
      ivec3 side_at = cell + ivec3(0, 0, (2 * axis + side) * grid.cells.z);
      int row = ROW_SIDE + side * SIDE_ROWS;
      float weight = sum(cell, axis, row);
      float scale = weight > 0. ? 1. / weight : 0.;
      imageStore(voxels_centroid, side_at, vec4(scale * sum3(cell, axis, row + 1), area));
      imageStore(voxels_albedo, side_at, vec4(clamp(scale * sum3(cell, axis, row + 4), 0., 1.), 1));
#if EMISSION
      // Per area of the whole side, emitting or not.
      vec3 emission = sum3(cell, axis, ROW_EMISSION + 3 * side) * (scale * max_emission);
      imageStore(voxels_emission, side_at, vec4(emission, 1));
#endif
    }
  }
  imageStore(voxels_coverage, cell, coverage);
}
