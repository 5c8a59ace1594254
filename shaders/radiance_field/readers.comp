// Marks the cells between probes that the surface of some pixel lies in, as probe_irradiance() in lib/probes.glsl finds
// them.
#include "interop/camera.h"
#include "interop/probes.h"
#include "lib/camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform readers_data { Camera camera; };
layout(std140) uniform field_data { ProbeGrid grid; };
uniform sampler2D readers_depth;
layout(std430) restrict buffer scratch_read_cells { uint read_cells[]; };  // [z][y][x] of the probe at the lower corner

const float slack = 1e-3;  // grid steps: two programs may round differently

void mark(vec3 at) {
  ivec3 base = clamp(ivec3(floor(clamp(at, vec3(0), vec3(grid.counts.xyz - 1)))), ivec3(0),
                     max(grid.counts.xyz - 2, ivec3(0)));
  read_cells[base.x + grid.counts.x * (base.y + grid.counts.y * base.z)] = 1u;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(readers_depth, 0)))) return;
  float depth = texelFetch(readers_depth, pixel, 0).r;
  if (depth <= 0.) return;
  vec3 at = (surface_position(camera, pixel_uv(camera, pixel), depth) - grid.lower.xyz) / grid.spacing.xyz;
  for (int i = 0; i < 8; ++i) mark(at + slack * (2. * vec3(i & 1, (i >> 1) & 1, i >> 2) - 1.));
}
