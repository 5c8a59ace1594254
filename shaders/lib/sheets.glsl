// The sides of the sheets of a voxelized scene: where light arrives, and what it leaves with. Slab 2·axis + side of the
// volumes belongs to the side that looks to the positive (0) or negative (1) end of the axis.
//
// The including file may define
//   SHEET_ALBEDO(texel)  albedo and, in a, the area that the side shows, in cell faces; without it: voxels_albedo
#ifndef LOOM_LIB_SHEETS_GLSL
#define LOOM_LIB_SHEETS_GLSL
#include "lib/voxels.glsl"

uniform sampler3D voxels_centroid;
#ifndef SHEET_ALBEDO
uniform sampler3D voxels_albedo;
#define SHEET_ALBEDO(texel) texelFetch(voxels_albedo, texel, 0)
#endif

struct SheetSide {
  ivec3 texel;    // of the volumes by side
  vec3 position;  // world, metres
  vec3 normal;    // unit
  vec3 albedo;
  float area;       // that the side shows, m²
  vec3 across, up;  // edges of the rectangle that the sheet spans, on its plane, metres
  vec3 corner;      // where they begin
};

// False where there is no sheet.
bool sheet_side(ivec3 cell, int axis, int side, out SheetSide s) {
  s.texel = cell + ivec3(0, 0, (2 * axis + side) * grid.cells.z);
  vec4 albedo = SHEET_ALBEDO(s.texel);
  s.albedo = albedo.rgb;
  s.area = albedo.a * grid.cascade[0].w * grid.cascade[0].w;
  vec3 n = texelFetch(voxels_plane, cell + ivec3(0, 0, axis * grid.cells.z), 0).xyz;
  if (n == vec3(0)) return false;
  s.normal = side == 0 ? normalize(n) : -normalize(n);
  vec3 middle = texelFetch(voxels_centroid, s.texel, 0).xyz;
  s.position = grid.cascade[0].xyz + (vec3(cell) + .5 + middle) * grid.cascade[0].w;
  // The rectangle is given across the axis (u, v); the plane through the side's centroid says how high it lies (w).
  vec3 slope = turn_axis_last(s.normal, axis);
  vec4 extent = texelFetch(voxels_extent, cell + ivec3(0, 0, axis * grid.cells.z), 0) - .5;
  vec2 from = extent.xy - turn_axis_last(middle, axis).xy;
  float size = grid.cascade[0].w;
  s.across = size * turn_axis_back(vec3(extent.z - extent.x, 0, -slope.x / slope.z * (extent.z - extent.x)), axis);
  s.up = size * turn_axis_back(vec3(0, extent.w - extent.y, -slope.y / slope.z * (extent.w - extent.y)), axis);
  s.corner = s.position + size * turn_axis_back(vec3(from, -dot(slope.xy, from) / slope.z), axis);
  return true;
}
#endif
