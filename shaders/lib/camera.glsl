// Rays of a camera, and the way back from depth (distance along the ray) to a position.
#ifndef LOOM_LIB_CAMERA_GLSL
#define LOOM_LIB_CAMERA_GLSL
#include "interop/camera.h"

// Centre of a pixel in the image, (0,0) bottom left to (1,1) top right.
vec2 pixel_uv(Camera camera, ivec2 pixel) { return (vec2(pixel) + .5) * camera.size.zw; }

bool is_orthographic(Camera camera) { return camera.eye.w > .5; }

// Where uv lies on the image plane, in half-widths from its middle.
vec2 image_plane(Camera camera, vec2 uv) { return 2. * uv - 1. + vec2(camera.right.w, camera.up.w); }

vec3 ray_origin(Camera camera, vec2 uv) {
  vec2 s = is_orthographic(camera) ? image_plane(camera, uv) : vec2(0);
  return camera.eye.xyz + s.x * camera.right.xyz + s.y * camera.up.xyz;
}

// Unit vector.
vec3 ray_direction(Camera camera, vec2 uv) {
  vec2 s = is_orthographic(camera) ? vec2(0) : image_plane(camera, uv);
  return normalize(camera.forward.xyz + s.x * camera.right.xyz + s.y * camera.up.xyz);
}

// Clip-space position of a world position. The eye is subtracted first: far from the origin the translation within
// view_proj would cancel only after rounding.
vec4 project(Camera camera, vec3 position) {
  return camera.proj * vec4(mat3(camera.view) * (position - camera.eye.xyz), 1);
}

vec3 surface_position(Camera camera, vec2 uv, float depth) {
  return ray_origin(camera, uv) + depth * ray_direction(camera, uv);
}
#endif
