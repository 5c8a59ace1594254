// E(x) = Σ (Φ_j/π)·min(G_j, b)·V_j over the lights, or over the part of them that the pixel of a tile takes.
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/sampling.glsl"
#include "lib/trace.glsl"
#include "lib/vpls.glsl"
#if VOXELS
#include "lib/voxels.glsl"
#endif
#if MAPS
#include "lib/vpl_shadows.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform int interleave;
uniform float min_distance;
uniform float box_area;  // of the scene's box, m²
// Each dispatch takes so many lights, and leaves the sums to the next.
uniform int at_once;
uniform int dispatches;
uniform int index;
#if SEVERAL
layout(rgba32f) uniform image2D scratch_given;
layout(rgba32f) uniform image2D scratch_taken;
#endif
#if IRRADIANCE
writeonly uniform image2D irradiance_irradiance;
#endif
#if CLAMPED
writeonly uniform image2D clamped_irradiance;
#endif

struct Point {
  vec3 x, n, n_g;  // position, shading and geometric normal
  float extent;    // distance over which x was computed
};

// b, 1/m².
float bound() {
  return min_distance > 0. ? pi * float(vpl_set.count.x) / (min_distance * min_distance * box_area) : 3e38;
}

// Share of what the light sends to x that arrives.
float visibility(Point p, uint j) {
  Vpl light = vpls[j];
#if MAPS
  uint map = vpl_map_of[j];
  if (map > 0u) return mapped_visibility(map, light, p.x, p.n_g, p.extent);
#endif
#if RAYS
  return segment_occluded(p.x, p.n_g, p.extent, light.position.xyz, light.normal.xyz, 0.) ? 0. : 1.;
#elif VOXELS
  vec3 d = light.position.xyz + .5 * grid.cascade[0].w * light.normal.xyz - p.x;
  float r = length(d);
  return march(p.x, d / max(r, 1e-30), p.n_g, r).transmittance;
#else
  return 1.;
#endif
}

// ⟨n_j, x−x_j⟩₊⟨n, x_j−x⟩₊/r⁴, 1/m².
float geometry_term(Point p, vec3 position, vec3 normal) {
  vec3 d = position - p.x;
  float square = max(dot(d, d), 1e-30);
  // What the triangle of x hides from x is hidden, whatever the shading normal says.
  if (dot(d, p.n_g) <= 0.) return 0.;
  return max(0., dot(p.n, d)) * max(0., -dot(normal, d)) / square / square;
}

// What lights [first, end) give: bounded, and what the bound took away.
void gather(Point p, uint first, uint end, float b, out vec3 given, out vec3 taken) {
  given = taken = vec3(0);
  for (uint j = first; j < end; ++j) {
    float g = geometry_term(p, vpls[j].position.xyz, vpls[j].normal.xyz);
    if (g <= 0.) continue;
    float v = visibility(p, j);
    vec3 intensity = inverse_pi * v * vpls[j].flux.rgb;
    given += intensity * min(g, b);
    taken += intensity * max(g - b, 0.);
  }
}

#if COMPENSATION
#include "gather_vpls/compensation.glsl"
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(surface_depth, 0)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 given = vec3(0), taken = vec3(0);
  if (depth > 0.) {
    Point p;
    p.x = surface_position(camera, pixel_uv(camera, pixel), depth);
    p.n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    p.n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    p.extent = depth;
    // Another part for each sub-pixel sample; parts that follow each other are no neighbours in the tile.
    uint side = uint(clamp(interleave, 1, 16)), parts = side * side;
    uvec2 in_tile = uvec2(pixel) % side;
    uint part = (in_tile.x + side * in_tile.y + frame.random.z * (parts / 2u + 1u)) % parts;
    uint end = vpl_first((part + 1u) * LOOM_VPL_GROUPS / parts);
    uint first = min(vpl_first(part * LOOM_VPL_GROUPS / parts) + uint(index) * uint(at_once), end);
    float b = bound();
    gather(p, first, min(first + uint(at_once), end), b, given, taken);
    given *= float(parts);
    taken *= float(parts);
#if COMPENSATION && IRRADIANCE
    given += compensate(p, b, pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x636f6d70u));
#endif
  }
#if SEVERAL
  if (index > 0) {
    given += imageLoad(scratch_given, pixel).rgb;
    taken += imageLoad(scratch_taken, pixel).rgb;
  }
  if (index < dispatches - 1) {
    imageStore(scratch_given, pixel, vec4(given, 1));
    imageStore(scratch_taken, pixel, vec4(taken, 1));
    return;
  }
#endif
#if IRRADIANCE
  imageStore(irradiance_irradiance, pixel, vec4(given, 1));
#endif
#if CLAMPED
  imageStore(clamped_irradiance, pixel, vec4(taken, 1));
#endif
}
