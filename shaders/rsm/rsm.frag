// Flux, normal and distance of what one texel of a light face sees.
#include "interop/light.h"
#include "lib/material.glsl"
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"

layout(std430) readonly restrict buffer scratch_faces { LightFace faces[]; };
#ifdef FLUX_LOCATION
layout(location = FLUX_LOCATION) out vec4 out_flux;
#endif
#ifdef NORMAL_LOCATION
layout(location = NORMAL_LOCATION) out vec4 out_normal;
#endif
#ifdef DEPTH_LOCATION
layout(location = DEPTH_LOCATION) out float out_depth;
#endif

uniform int map_size;

void main() {
  LightFace face = faces[gl_Layer];
  vec3 albedo = surface_albedo();
  if (!surface_visible()) discard;
  vec3 d = vertex.position - face.origin.xyz;
#ifdef FLUX_LOCATION
  vec2 q = texel_plane(ivec2(gl_FragCoord.xy), map_size);
  vec3 towards = is_directional(face) ? face.forward.xyz : normalize(face_ray(face, q));
  out_flux = vec4(albedo * light_intensity(lights[int(face.origin.w)], towards) * texel_measure(face, q, map_size), 1);
#endif
#ifdef NORMAL_LOCATION
  out_normal = vec4(surface_geometric_normal(), 0);
#endif
#ifdef DEPTH_LOCATION
  out_depth = is_directional(face) ? dot(d, face.forward.xyz) : length(d);
#endif
}
