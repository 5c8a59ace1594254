// What the faces around each cell of one cascade do to light: the share that they let in, and B·ρ of what they reflect.
#include "lpv/state.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

uniform sampler3D blockers_occupancy;  // of each cell's three lower faces
uniform sampler3D blockers_albedo;     // [axis][cascade][cell.z] slices
layout(rgba32ui) uniform writeonly uimage3D scratch_open;
layout(rgba32ui) uniform writeonly uimage3D scratch_reflect;
uniform int cascade;

// The blocked share of the lower face of `cell` along an axis; the faces behind the last cells stand open.
float face_share(ivec3 cell, int axis) {
  if (cell[axis] >= grid.cells[axis]) return 0.;
  return clamp(texelFetch(blockers_occupancy, cell + ivec3(0, 0, cascade * grid.cells.z), 0)[axis], 0., 1.);
}
vec3 face_albedo(ivec3 cell, int axis) {
  if (cell[axis] >= grid.cells[axis]) return vec3(0);
  return clamp(texelFetch(blockers_albedo, cell + ivec3(0, 0, (axis * grid.cells.w + cascade) * grid.cells.z), 0).rgb, 0.,
               1.);
}

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, grid.cells.xyz))) return;
  uvec3 open;
  uvec3 reflected[3];
  for (int axis = 0; axis < 3; ++axis) {
    ivec3 next = cell;
    next[axis] += 1;
    vec2 share = vec2(face_share(cell, axis), face_share(next, axis));  // lower face, upper face
    open[axis] = pack_shares(1. - share);
    vec3 lower = face_albedo(cell, axis), upper = face_albedo(next, axis);
    for (int channel = 0; channel < 3; ++channel) {
      reflected[channel][axis] = pack_shares(share.yx * vec2(upper[channel], lower[channel]));
    }
  }
  imageStore(scratch_open, cell, uvec4(open, 0u));
  for (int channel = 0; channel < 3; ++channel) {
    imageStore(scratch_reflect, cell + ivec3(0, 0, channel * grid.cells.z), uvec4(reflected[channel], 0u));
  }
}
