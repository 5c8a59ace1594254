// Sums to means: the sheets of one cell.
#include "lib/axes.glsl"
#include "lib/math.glsl"
#include "voxelize/channels.glsl"
#include "voxelize/sums.glsl"
layout(local_size_x = 32) in;

layout(rgba16f) uniform writeonly image3D voxels_coverage;
layout(rgba16f) uniform writeonly image3D voxels_plane;
layout(rgba8) uniform writeonly image3D voxels_extent;
#if CENTROID
layout(rgba16f) uniform writeonly image3D voxels_centroid;
#endif
#if ALBEDO
layout(ALBEDO_FORMAT) uniform writeonly image3D voxels_albedo;
#endif
#if EMISSION
layout(LIGHT_FORMAT) uniform writeonly image3D voxels_emission;
uniform float max_emission;
#endif
#if RADIANCE
layout(LIGHT_FORMAT) uniform writeonly image3D voxels_radiance;
#endif

struct Side {
  float weight;
  vec3 position, albedo, emission;  // Σ w·…
};

struct Sheet {
  float area;
  float opaque;           // of it, what COMBINE lets count
  vec3 normal, position;  // Σ a·…
  vec3 low, high;         // its box, from the cell's lower corner, in cells
  Side side[2];
};

float sum(ivec3 cell, int axis, int row) { return float(sums[sum_index(cell, axis, row)]) / FIXED; }
vec3 sum3(ivec3 cell, int axis, int row) {
  return vec3(sum(cell, axis, row), sum(cell, axis, row + 1), sum(cell, axis, row + 2));
}

Sheet sheet_of(ivec3 cell, int axis) {
  Sheet s;
  s.area = sum(cell, axis, ROW_AREA);
  s.opaque = COMBINE == COMBINE_MAX ? sum(cell, axis, ROW_LARGEST) : s.area;
  s.normal = sum3(cell, axis, ROW_NORMAL);
  s.position = sum3(cell, axis, ROW_POSITION);
  s.low = 1. - sum3(cell, axis, ROW_BOX) * (FIXED / 255.);
  s.high = sum3(cell, axis, ROW_BOX + 3) * (FIXED / 255.);
  for (int i = 0; i < 2; ++i) {
    int row = ROW_SIDE + i * SIDE_ROWS;
    s.side[i].weight = sum(cell, axis, row);
    s.side[i].position = sum3(cell, axis, row + 1);
    s.side[i].albedo = sum3(cell, axis, row + 4);
#if EMISSION
    s.side[i].emission = sum3(cell, axis, ROW_EMISSION + 3 * i);
#else
    s.side[i].emission = vec3(0);
#endif
  }
  return s;
}

// A smooth surface at 45° to two axes has triangles of both. Where the sheets of two axes are nearly parallel they are
// one, or each would cover a part of what the other spans and light would pass in between.
const float PARALLEL = .85;

void merge(inout Sheet into, inout Sheet from) {
  float lengths = length(into.normal) * length(from.normal);
  float along = dot(into.normal, from.normal);
  if (into.area < from.area || from.area <= 0. || abs(along) <= PARALLEL * lengths) return;
  bool opposite = along < 0.;  // positive on one axis, negative on the other
  into.area += from.area;
  into.opaque = COMBINE == COMBINE_MAX ? max(into.opaque, from.opaque) : into.opaque + from.opaque;
  into.normal += opposite ? -from.normal : from.normal;
  into.position += from.position;
  into.low = min(into.low, from.low);
  into.high = max(into.high, from.high);
  for (int i = 0; i < 2; ++i) {
    Side side = from.side[opposite ? 1 - i : i];
    into.side[i].weight += side.weight;
    into.side[i].position += side.position;
    into.side[i].albedo += side.albedo;
    into.side[i].emission += side.emission;
  }
  from.area = 0.;
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
  // A plane that is a face of the cell is inside: half of the softened step would lie beyond.
  float face = .5 * n.z, edge = 2e-3;
  if (a + b < edge && abs(abs(t) - face) < edge) t = sign(t) * (face - edge);
  return span.x * span.y * (share_below(t + .5 * n.z, a, b) - share_below(t - .5 * n.z, a, b)) / n.z;
}

void store_sheet(ivec3 cell, int axis, Sheet s, inout vec4 coverage) {
  vec4 plane = vec4(0), extent = vec4(0);
  float seen = 0.;  // area that either side shows, in cell faces: of two parallel surfaces each shows one
  if (s.area > 0.) {
    vec3 mean = s.normal / s.area;  // its length is the flatness: 1 where all triangles are parallel
    vec3 n = normalize(mean);
    if (n[axis] < 0.) n = -n;
    float offset = dot(n, s.position / s.area);
    plane = vec4(n * length(mean), offset);
    extent = vec4(turn_axis_last(s.low, axis).xy, turn_axis_last(s.high, axis).xy);
    if (COMBINE == COMBINE_OR) extent = vec4(0, 0, 1, 1);
    float section = section_area(turn_axis_last(n, axis), offset, extent);
    seen = COMBINE == COMBINE_OR ? section : min(s.opaque, section);
    coverage[axis] = seen < section ? seen / section : 1.;
    coverage.w = 1.;
  }
  ivec3 at = cell + ivec3(0, 0, axis * grid.cells.z);
  imageStore(voxels_plane, at, plane);
  imageStore(voxels_extent, at, extent);
  for (int i = 0; i < 2; ++i) {
    ivec3 side_at = cell + ivec3(0, 0, (2 * axis + i) * grid.cells.z);
    Side side = s.side[i];
    float scale = s.area > 0. && side.weight > 0. ? 1. / side.weight : 0.;
    vec3 albedo = clamp(scale * side.albedo, 0., 1.);
#if CENTROID
    imageStore(voxels_centroid, side_at, vec4(scale * side.position, s.area));
#endif
#if ALBEDO
    imageStore(voxels_albedo, side_at, in_channels(albedo, seen));
#endif
#if RADIANCE
    // For the light that comes next, which makes radiance of it.
    imageStore(voxels_radiance, side_at, in_channels(albedo, 1.));
#endif
#if EMISSION
    // Per area of the whole side, emitting or not.
    imageStore(voxels_emission, side_at, stored(in_channels(scale * max_emission * side.emission, 1.)));
#endif
  }
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  Sheet x = sheet_of(cell, 0), y = sheet_of(cell, 1), z = sheet_of(cell, 2);
  // Into the larger one each, whichever that is.
  merge(x, y);
  merge(y, x);
  merge(x, z);
  merge(z, x);
  merge(y, z);
  merge(z, y);
  vec4 coverage = vec4(0);
  store_sheet(cell, 0, x, coverage);
  store_sheet(cell, 1, y, coverage);
  store_sheet(cell, 2, z, coverage);
  imageStore(voxels_coverage, cell, coverage);
}
