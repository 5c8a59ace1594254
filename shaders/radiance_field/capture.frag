// What one texel of a probe's cube sees.
#include "lib/material.glsl"
#include "lib/octahedral.glsl"
#include "radiance_field/texels.glsl"
layout(location = 0) out vec4 normals;  // shading, geometric
layout(location = 1) out vec4 surface;  // rgb: albedo; a: distance, metres, negative: the back of a single-sided face
flat in vec3 eye;

// Along the ray through the texel's centre, to the plane of the triangle: the rasteriser snaps corners to 1/256 of a
// texel, which is .06° of a cube face of 8², so that the interpolated position lies beside the ray. Where the plane is
// edge-on within that error, the interpolated position is what there is.
float distance_along(vec3 ray, vec3 n) {
  vec3 d = vertex.position - eye;
  float interpolated = length(d), exact = dot(n, d) / dot(n, ray);
  return abs(exact - interpolated) < .5 * interpolated ? exact : interpolated;
}

void main() {
  vec3 albedo = surface_albedo();
  if (!surface_visible()) discard;
  bool back = !surface_front() && !has_flag(MATERIAL_DOUBLE_SIDED);
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 n = surface_geometric_normal();
  float distance = distance_along(texel_direction((gl_Layer % 6 * face_size + at.y) * face_size + at.x), n);
  normals = vec4(octahedral_encode(surface_normal()), octahedral_encode(n));
  surface = vec4(albedo, back ? -distance : distance);
}
