// What Reflections and Refraction share: the surface, and what rays bring (lib/seen_along.glsl).
#include "interop/camera.h"
#include "interop/frame.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler2D surface_specular;
uniform int samples, steps;
uniform float thickness;
#include "lib/camera.glsl"
#include "lib/ggx.glsl"
#include "lib/parts.glsl"
#include "lib/sampling.glsl"

// Share of a surface that is glass, τ, and its index.
#if TRANSMISSION
uniform sampler2D surface_transmission;
vec2 glass_at(ivec2 pixel) { return texelFetch(surface_transmission, pixel, 0).rg; }
#else
vec2 glass_at(ivec2 pixel) { return vec2(0, 1.5); }
#endif
bool seen_through(ivec2 pixel) { return glass_at(pixel).x > .5; }
#include "lib/seen_along.glsl"

struct Surface {
  vec3 x, v, n, n_g;  // position, direction to the viewer, shading and geometric normal
};

Surface surface_at(ivec2 pixel, float depth) {
  vec2 uv = pixel_uv(camera, pixel);
  Surface at;
  at.v = -ray_direction(camera, uv);
  at.x = ray_origin(camera, uv) - depth * at.v;
  at.n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  at.n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  // A normal map may turn it away from the viewer: bent back to this cosine, as the reference does.
  at.n = normalize(at.n + at.v * max(0., 1e-3 - dot(at.n, at.v)));
  return at;
}
