// One more order of reflection at every side of every sheet: R' = R₁ + ρ/π·E, E = π/N · Σ R over cosine-distributed rays.
// R₁ is what the side reflects of straight light, R the reflected light of the order before.
#include "interop/frame.h"
#include "lib/sampling.glsl"
#include "lib/storage.glsl"
uniform sampler3D SOURCE;
#define SHEET_RADIANCE(cell, slab) texelFetch(SOURCE, cell + ivec3(0, 0, (slab) * grid.cells.z), 0).rgb
#include "lib/sheets.glsl"
layout(local_size_x = 32) in;

layout(std140) uniform frame_data { FrameData frame; };
uniform sampler3D voxels_radiance;
layout(FORMAT) uniform image3D TARGET;
uniform int rays;
uniform ivec2 part;  // of the rays: the first, and the one after the last
uniform int order;
uniform uint frame_seed;

// One side of a sheet a thread.
void main() {
  ivec3 id = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(id, grid.cells.xyz * ivec3(1, 1, 6)))) return;
  int slab = id.z / grid.cells.z;
  ivec3 cell = ivec3(id.xy, id.z - slab * grid.cells.z);
  SheetSide s;
  vec3 radiance = vec3(0);
  if (sheet_side(cell, slab >> 1, slab & 1, s) && s.albedo != vec3(0)) {
    uint seed = hash(uvec4(uvec3(s.texel), frame.random.x ^ uint(order) * 0x9e3779b9u ^ frame_seed * 0x85ebca6bu)).x;
    vec3 sum = vec3(0);
    for (int k = part.x; k < part.y; ++k) {
      vec3 w = cosine_hemisphere(low_discrepancy(uint(k), seed), s.normal);
      sum += march(s.position, w, s.normal, 1e30).radiance;
    }
    vec3 before = part.x == 0 ? texelFetch(voxels_radiance, s.texel, 0).rgb : CHANNELS(imageLoad(TARGET, s.texel));
    radiance = before + s.albedo * sum / float(rays);
  }
  imageStore(TARGET, s.texel, stored(vec4(radiance, 1)));
}
