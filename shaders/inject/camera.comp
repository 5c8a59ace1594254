// Surfaces that the camera sees are blockers: pixel solid angle · r²/<n,v>. They carry no light.
#include "inject/inject.glsl"
#include "interop/camera.h"
#include "lib/camera.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_geometric_normal;
uniform sampler2D surface_albedo;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(surface_depth, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  if (!(depth > 0.0)) return;
  vec2 uv = (vec2(pixel) + 0.5) * camera.size.zw;
  vec3 n = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  vec3 direction = ray_direction(camera, uv);
  float cosine = dot(n, -direction);
  if (!(cosine > 0.0)) return;
  float plane_area = 4.0 * length(camera.right.xyz) * length(camera.up.xyz) * camera.size.z * camera.size.w;
  float facing_area = plane_area;  // orthographic
  if (camera.eye.w == 0.0) {
    float c = dot(direction, camera.forward.xyz);
    facing_area = plane_area * c * c * c * depth * depth;
  }
  add_blocker(surface_position(camera, uv, depth), n, facing_area / cosine,
              texelFetch(surface_albedo, pixel, 0).rgb);
}
