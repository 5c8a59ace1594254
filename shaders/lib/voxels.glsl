// Rays through a voxelized scene. A cell holds up to three sheets, one an axis: a plane, the rectangle that it spans
// across its axis, and the share of that rectangle that is opaque. A ray visits each cell on its way once (Amanatides
// and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987), meets each sheet where it crosses its plane, and
// goes on behind it with the share that the sheet lets through. So a wall thinner than a cell is a wall, and a surface
// that slants through the grid does not shade itself.
//
// The including file may define
//   SHEET_RADIANCE(cell, slab)  exitant radiance of the side of a sheet in slab 2·axis + side; without it: 0
//   SHEET_LIGHT(cell, slab, coverage, t, facing)  what of that counts for a ray that meets the side at t, in cells, with
//                               the cosine `facing`; without it: all
#ifndef LOOM_LIB_VOXELS_GLSL
#define LOOM_LIB_VOXELS_GLSL
#include "interop/grid.h"
#include "lib/axes.glsl"
#include "lib/grid.glsl"
#include "lib/math.glsl"

layout(std140) uniform voxels_data { Grid grid; };
uniform sampler3D voxels_coverage;
uniform sampler3D voxels_plane;
uniform sampler3D voxels_extent;

#ifndef SHEET_RADIANCE
#define SHEET_RADIANCE(cell, slab) vec3(0)
#endif
#ifndef SHEET_LIGHT
#define SHEET_LIGHT(cell, slab, coverage, t, facing) SHEET_RADIANCE(cell, slab)
#endif

struct March {
  vec3 radiance;        // Σ what the sheets send towards the origin, W/(m² sr)
  float transmittance;  // share that leaves the grid
  float distance;       // to where half of the ray has ended, metres; no_crossing where it has not
};

const float no_crossing = 3.402823466e38;
// Planes are means, and those of a bent surface do not meet at cell faces: by so much of a cell a ray may miss its cell.
const float SEAM = .05;
// A ray's own surface: a sheet this close to its origin, in cells, and parallel to it.
const float OWN_DISTANCE = .15;
const float OWN_COSINE = .7;
// What is left of a ray that is not followed any further.
const float LAST_SHARE = 1. / 512.;

struct Ray {
  vec3 origin;     // in cells
  vec3 direction;  // unit
  vec3 normal;     // of the surface that it leaves; 0: none
};

// The rectangle of a sheet as rays meet it. Where it ends inside its cell it ends: a seam there would make a lamp that is
// smaller than its cell larger than it is.
vec4 met_extent(ivec3 cell, int axis) {
  vec4 extent = texelFetch(voxels_extent, cell + ivec3(0, 0, axis * grid.cells.z), 0);
  const float face = 1.5 / 255.;
  return extent + SEAM * vec4(-step(extent.xy, vec2(face)), step(1. - face, extent.zw));
}

// Where the ray meets the sheet of `axis`, in cells along it, if that lies between `enter` and `leave`. `along`:
// ⟨n, direction⟩, negative where its positive side is met.
float cross_sheet(Ray ray, ivec3 cell, int axis, float enter, float leave, out float along) {
  vec4 plane = texelFetch(voxels_plane, cell + ivec3(0, 0, axis * grid.cells.z), 0);
  vec3 n = normalize(plane.xyz);
  along = dot(n, ray.direction);
  vec3 from = ray.origin - (vec3(cell) + .5);
  float gap = plane.w - dot(n, from);
  if (abs(gap) < OWN_DISTANCE && abs(dot(n, ray.normal)) > OWN_COSINE) return no_crossing;
  float t = gap / (abs(along) > 1e-12 ? along : 1e-12);
  if (!(t > 0. && t >= enter - SEAM && t <= leave + SEAM)) return no_crossing;
  vec4 extent = met_extent(cell, axis);
  vec2 at = turn_axis_last(from + t * ray.direction, axis).xy + .5;
  bool inside = all(greaterThanEqual(at, extent.xy)) && all(lessThanEqual(at, extent.zw));
  return inside ? t : no_crossing;
}

// What one cell does to the ray: its sheets, nearest first.
void cross_cell(Ray ray, ivec3 cell, vec3 coverage, float enter, float leave, inout March march) {
  vec3 at = vec3(no_crossing), along = vec3(0);
  ivec3 slab = ivec3(0);
  // Sheet by sheet and not axis by axis: the lanes of a SIMD group have theirs on different axes.
  vec3 left = coverage;
  while (left != vec3(0)) {
    int axis = left.x > 0. ? 0 : left.y > 0. ? 1 : 2;
    left[axis] = 0.;
    float facing;
    at[axis] = cross_sheet(ray, cell, axis, enter, leave, facing);
    along[axis] = facing;
    slab[axis] = 2 * axis + (facing < 0. ? 0 : 1);
  }
  // Sheets of one cell are pieces of one surface, side by side: what they cover adds up. Those of different cells are
  // independent: what they let through multiplies.
  float arriving = march.transmittance, open = 1.;
  for (int i = 0; i < 3; ++i) {
    int axis = at.x <= at.y && at.x <= at.z ? 0 : at.y <= at.z ? 1 : 2;
    if (at[axis] == no_crossing) return;
    float covered = min(coverage[axis], open);
    open -= covered;
    march.radiance +=
        arriving * covered * SHEET_LIGHT(cell, slab[axis], coverage[axis], at[axis], abs(along[axis]));
    float before = march.transmittance;
    march.transmittance = arriving * open;
    if (before >= .5 && march.transmittance < .5) march.distance = at[axis] * grid.cascade[0].w;
    at[axis] = no_crossing;
  }
}

// Follows a ray from a point in the world until it leaves the grid or nothing is left of it. `normal`: of the surface
// that it starts from (unit, either side; 0 in free space). `reach`: where it ends, metres.
March march(vec3 position, vec3 direction, vec3 normal, float reach) {
  Ray ray = Ray(grid_coordinates(grid, 0, position), direction, normal);
  March result = March(vec3(0), 1., no_crossing);
  vec3 reciprocal = 1. / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  vec3 limit = vec3(grid.cells.xyz);
  // From outside the ray enters first.
  vec3 t0 = -ray.origin * reciprocal, t1 = (limit - ray.origin) * reciprocal;
  vec3 near = min(t0, t1), far = min(max(t0, t1), vec3(reach / grid.cascade[0].w));
  float enter = max(max(near.x, near.y), max(near.z, 0.)), end = min(far.x, min(far.y, far.z));
  if (!(enter < end)) return result;

  ivec3 cell = clamp(ivec3(floor(ray.origin + enter * direction)), ivec3(0), grid.cells.xyz - 1);
  ivec3 forth = ivec3(mix(vec3(-1), vec3(1), greaterThanEqual(direction, vec3(0))));
  vec3 next = (vec3(cell) + vec3(max(forth, ivec3(0))) - ray.origin) * reciprocal;
  vec3 step = abs(reciprocal);
  ivec3 found = cell;
  // All lanes of a SIMD group look for their next occupied cell, then all cross what they found (Aila and Laine,
  // "Understanding the Efficiency of Ray Traversal on GPUs", 2009).
  int left = grid.cells.x + grid.cells.y + grid.cells.z;
  bool inside = true;
  while (inside) {
    vec4 coverage = vec4(0);
    float from = enter, leave = enter;
    while (inside && coverage.w == 0.) {
      coverage = texelFetch(voxels_coverage, cell, 0);
      from = enter;
      leave = min(next.x, min(next.y, next.z));
      found = cell;
      int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
      cell[axis] += forth[axis];
      next[axis] += step[axis];
      enter = leave;
      --left;
      inside = leave < end && left > 0 && cell[axis] >= 0 && cell[axis] < grid.cells[axis];
    }
    if (coverage.w > 0.) {
      cross_cell(ray, found, coverage.xyz, from, min(leave, end), result);
      if (result.transmittance < LAST_SHARE) {
        result.transmittance = 0.;
        inside = false;
      }
    }
  }
  return result;
}
#endif
