// The nearest surface at each pixel, into as many targets as are read: DEPTH, NORMAL, … are defined for those, as the
// number of the target.
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/material.glsl"

layout(std140) uniform frame_data { FrameData frame; };

#ifdef DEPTH
layout(location = DEPTH) out float out_depth;
#endif
#ifdef NORMAL
layout(location = NORMAL) out vec4 out_normal;
#endif
#ifdef GEOMETRIC_NORMAL
layout(location = GEOMETRIC_NORMAL) out vec4 out_geometric_normal;
#endif
#ifdef ALBEDO
layout(location = ALBEDO) out vec4 out_albedo;
#endif
#ifdef EMISSION
layout(location = EMISSION) out vec4 out_emission;
#endif
#ifdef SPECULAR
layout(location = SPECULAR) out vec4 out_specular;
#endif
#ifdef TRANSMISSION
layout(location = TRANSMISSION) out vec4 out_transmission;
#endif

// Distance along the ray through the pixel's sample.
float ray_depth() {
  vec2 uv = gl_FragCoord.xy * frame.camera.size.zw;
  return dot(vertex.position - ray_origin(frame.camera, uv), ray_direction(frame.camera, uv));
}

void main() {
#ifdef DEPTH
  out_depth = ray_depth();
#endif
#ifdef NORMAL
  out_normal = vec4(surface_normal(), 0);
#endif
#ifdef GEOMETRIC_NORMAL
  out_geometric_normal = vec4(surface_geometric_normal(), 0);
#endif
#ifdef ALBEDO
  out_albedo = vec4(surface_albedo(), 1);
#endif
#ifdef EMISSION
  out_emission = vec4(surface_emission(), 1);
#endif
#ifdef SPECULAR
  out_specular = surface_specular();
#endif
#ifdef TRANSMISSION
  out_transmission = vec4(surface_transmission(), surface_ior(), 0, 0);
#endif
#ifdef SCENE_ALPHA_MASK
  if (!surface_visible()) discard;
#endif
}
