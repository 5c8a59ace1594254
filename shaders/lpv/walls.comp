// What the faces around each cell of one cascade do to light: the share that they let in, and B·ρ of what they reflect.
#include "lpv/state.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

#if DIRECTIONAL
uniform sampler3D blockers_directional;  // SH of the blocked share by direction of travel, at lower corners of cells
#else
uniform sampler3D blockers_occupancy;  // of each cell's three lower faces
#endif
uniform sampler3D blockers_albedo;  // [axis][cascade][cell.z] slices
layout(rgba32ui) uniform writeonly uimage3D scratch_open;
layout(rgba32ui) uniform writeonly uimage3D scratch_reflect;
uniform int cascade;

// The blocked shares of the lower face of `cell` along an axis, for light that travels with the axis and against it; the
// faces behind the last cells stand open.
vec2 face_shares(ivec3 cell, int axis) {
  if (cell[axis] >= grid.cells[axis]) return vec2(0);
  ivec3 slab = ivec3(0, 0, cascade * grid.cells.z);
#if DIRECTIONAL
  // At the middle of the face: the mean of its four corners.
  vec4 mean = vec4(0);
  for (int corner = 0; corner < 4; ++corner) {
    ivec3 at = cell;
    at[(axis + 1) % 3] += corner & 1;
    at[(axis + 2) % 3] += corner >> 1;
    mean += 0.25 * texelFetch(blockers_directional, min(at, grid.cells.xyz - 1) + slab, 0);
  }
  vec3 along = vec3(0);
  along[axis] = 1.0;
  return clamp(vec2(dot(mean, sh2_basis(along)), dot(mean, sh2_basis(-along))), 0., 1.);
#else
  return vec2(clamp(texelFetch(blockers_occupancy, cell + slab, 0)[axis], 0., 1.));
#endif
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
  uvec3 reflected[CHANNELS];
  for (int axis = 0; axis < 3; ++axis) {
    ivec3 next = cell;
    next[axis] += 1;
    vec2 below = face_shares(cell, axis), above = face_shares(next, axis);
    // In through the lower face along the axis, or through the upper one against it; out by the upper or the lower.
    open[axis] = pack_shares(1. - vec2(below.x, above.y));
    vec3 lower = face_albedo(cell, axis), upper = face_albedo(next, axis);
    for (int channel = 0; channel < CHANNELS; ++channel) {
      reflected[channel][axis] = pack_shares(vec2(above.x * upper[channel], below.y * lower[channel]));
    }
  }
  imageStore(scratch_open, cell, uvec4(open, 0u));
  for (int channel = 0; channel < CHANNELS; ++channel) {
    imageStore(scratch_reflect, cell + ivec3(0, 0, channel * grid.cells.z), uvec4(reflected[channel], 0u));
  }
}
