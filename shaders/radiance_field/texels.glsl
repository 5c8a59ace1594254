// What the probes of one update see. A slot is a probe's place in the update. Each has the texels of six cube faces +X −X +Y −Y +Z −Z; along a face, right × up = −forward, as a camera has it.
#ifndef LOOM_RADIANCE_FIELD_TEXELS_GLSL
#define LOOM_RADIANCE_FIELD_TEXELS_GLSL
#include "interop/probes.h"
#include "lib/light.glsl"
#include "lib/octahedral.glsl"

layout(std140) uniform field_data { ProbeGrid grid; };
layout(std430) readonly restrict buffer scratch_probes { int probes[]; };  // [slot]
layout(std430) restrict buffer STATE_BLOCK { vec4 states[]; };  // of all probes, as the output `state`
struct Texel {
  Light radiance;  // of the first reflection, W/(m² sr)
  float distance;  // metres; 0 = nothing seen, negative: the back of a single-sided face
};
layout(std430) restrict buffer scratch_texels { Texel texels[]; };  // [slot][texel]
// [slot][texel]: shading and geometric normal (octahedral), albedo in half floats.
layout(std430) restrict buffer scratch_surfaces { uvec4 surfaces[]; };

uniform int face_size;
uniform int slot_count;

int probe_count() { return grid.counts.x * grid.counts.y * grid.counts.z; }
int texel_count() { return 6 * face_size * face_size; }
int probe_of(int slot) { return clamp(probes[clamp(slot, 0, slot_count - 1)], 0, probe_count() - 1); }

int probe_index(ivec3 probe) { return probe.x + grid.counts.x * (probe.y + grid.counts.y * probe.z); }
ivec3 probe_at(int index) {
  return ivec3(index % grid.counts.x, (index / grid.counts.x) % grid.counts.y,
               index / (grid.counts.x * grid.counts.y));
}

vec3 standing_at(int probe) {
  return grid.lower.xyz + vec3(probe_at(probe)) * grid.spacing.xyz + states[probe].xyz;
}

void cube_face(int face, out vec3 right, out vec3 up, out vec3 forward) {
  int axis = face >> 1;
  bool positive = (face & 1) == 0;
  right = up = forward = vec3(0);
  forward[axis] = positive ? 1. : -1.;
  right[(axis + (positive ? 2 : 1)) % 3] = 1.;
  up[(axis + (positive ? 1 : 2)) % 3] = 1.;
}

// Unit direction of the centre of texel t = (face·size + row)·size + column.
vec3 texel_direction(int t) {
  vec3 right, up, forward;
  cube_face(t / (face_size * face_size), right, up, forward);
  vec2 q = (2. * vec2(t % face_size, (t / face_size) % face_size) + 1.) / float(face_size) - 1.;
  return normalize(forward + q.x * right + q.y * up);
}

// The texel that a direction falls into.
int texel_towards(vec3 w) {
  vec3 m = abs(w), right, up, forward;
  int axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  int face = 2 * axis + (w[axis] < 0. ? 1 : 0);
  cube_face(face, right, up, forward);
  vec2 q = vec2(dot(w, right), dot(w, up)) / m[axis];
  ivec2 at = clamp(ivec2(floor(.5 * (q + 1.) * float(face_size))), ivec2(0), ivec2(face_size - 1));
  return (face * face_size + at.y) * face_size + at.x;
}

struct Surfel {
  vec3 n, n_g, albedo;
};

uvec4 pack_surfel(Surfel s) {
  return uvec4(packSnorm2x16(octahedral_encode(s.n)), packSnorm2x16(octahedral_encode(s.n_g)),
               packHalf2x16(s.albedo.rg), packHalf2x16(vec2(s.albedo.b, 0)));
}

Surfel unpack_surfel(uvec4 bits) {
  return Surfel(octahedral_decode(unpackSnorm2x16(bits.x)), octahedral_decode(unpackSnorm2x16(bits.y)),
                vec3(unpackHalf2x16(bits.z), unpackHalf2x16(bits.w).x));
}
#endif
