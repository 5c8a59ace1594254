// What tells surfaces apart in an image filter: distance from a plane, in the width of a pixel there.
#ifndef LOOM_LIB_EDGE_GLSL
#define LOOM_LIB_EDGE_GLSL
#include "lib/camera.glsl"
#include "lib/math.glsl"

// Width on the surface, seen head-on, of the pixel that sees it at distance `depth` along its ray; metres.
float pixel_footprint(Camera camera, vec2 uv, float depth) {
  float along = is_orthographic(camera) ? 1. : depth * dot(ray_direction(camera, uv), camera.forward.xyz);
  return 2. * length(camera.right.xyz) * camera.size.z * along;
}

// The greater of the distances of two surface points from each other's plane; `between` leads from one to the
// other.
float mutual_plane_distance(vec3 between, vec3 normal_a, vec3 normal_b) {
  return max(abs(dot(between, normal_a)), abs(dot(between, normal_b)));
}

bool is_finite(vec3 v) { return all(notEqual(floatBitsToUint(v) & 0x7f800000u, uvec3(0x7f800000u))); }
#endif
