// Irradiance straight from all punctual lights, with shadows by the lights' maps.
#ifndef LOOM_LIB_PUNCTUAL_LIGHT_GLSL
#define LOOM_LIB_PUNCTUAL_LIGHT_GLSL
#include "lib/light_shadow.glsl"
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"

// n: shading normal, n_g: geometric normal, both unit and on the lit side.
vec3 punctual_irradiance(vec3 x, vec3 n, vec3 n_g) {
  vec3 sum = vec3(0);
  for (int i = 0; i < lights.length(); ++i) {
    vec3 l;
    vec3 arriving = light_irradiance(lights[i], x, l);
    float cosine = dot(n, l);
    if (cosine <= 0. || dot(n_g, l) <= 0. || arriving == vec3(0)) continue;
    sum += arriving * cosine * light_visibility(lights[i], x, n_g, false);
  }
  return sum;
}
#endif
