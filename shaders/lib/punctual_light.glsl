// Irradiance straight from all punctual lights, with shadows by the lights' maps.
#ifndef LOOM_LIB_PUNCTUAL_LIGHT_GLSL
#define LOOM_LIB_PUNCTUAL_LIGHT_GLSL
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"
#include "lib/shadow.glsl"
layout(std430) readonly restrict buffer lights_faces { LightFace faces[]; };
uniform sampler2DArray lights_shadow;

// The light face that looks at x.
int face_of(Light light, vec3 x) {
  int layer = int(light.direction.w);
  if (int(light.intensity.w) != 6) return layer;
  vec3 d = x - light.position.xyz, m = abs(d);  // cube faces +X −X +Y −Y +Z −Z
  int axis = m.x >= m.y && m.x >= m.z ? 0 : m.y >= m.z ? 1 : 2;
  return layer + 2 * axis + (d[axis] < 0. ? 1 : 0);
}

// n: shading normal, n_g: geometric normal, both unit and on the lit side.
vec3 punctual_irradiance(vec3 x, vec3 n, vec3 n_g) {
  vec3 sum = vec3(0);
  for (int i = 0; i < lights.length(); ++i) {
    vec3 l;
    vec3 arriving = light_irradiance(lights[i], x, l);
    float cosine = dot(n, l);
    if (cosine <= 0. || dot(n_g, l) <= 0. || arriving == vec3(0)) continue;
    int layer = face_of(lights[i], x);
    vec3 projected = face_project(faces[layer], x);
    float visibility = 1.;
    if (projected.z > 0.) {
      visibility = shadow_visibility(lights_shadow, faces[layer], layer, projected.xy, x, n_g, false);
    }
    sum += arriving * cosine * visibility;
  }
  return sum;
}
#endif
