// Visibility of a light by the shadow maps of a LightLayers input called `lights`.
#ifndef LOOM_LIB_LIGHT_SHADOW_GLSL
#define LOOM_LIB_LIGHT_SHADOW_GLSL
#include "lib/shadow.glsl"

layout(std430) readonly restrict buffer lights_faces { LightFace faces[]; };
uniform sampler2DArray lights_shadow;

// Share of the light that reaches x; n: unit geometric normal on the lit side.
float light_visibility(Light light, vec3 x, vec3 n, bool filtered) {
  int layer = int(light.direction.w);
  if (int(light.intensity.w) == 6) {  // cube faces +X −X +Y −Y +Z −Z
    vec3 d = x - light.position.xyz, m = abs(d);
    int axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
    layer += 2 * axis + (d[axis] < 0. ? 1 : 0);
  }
  LightFace face = faces[layer];
  vec3 projected = face_project(face, x);
  if (projected.z <= 0.) return 1.;
  return shadow_visibility(lights_shadow, face, layer, projected.xy, x, n, filtered);
}
#endif
