// Visibility of the punctual lights in the way that a pass was asked for: SHADOW is SHADOW_none, SHADOW_map (of a
// LightLayers input called `lights`, with the parameter `pcf`) or SHADOW_ray.
#ifndef LOOM_LIB_PUNCTUAL_SHADOW_GLSL
#define LOOM_LIB_PUNCTUAL_SHADOW_GLSL
#define SHADOW_none 0
#define SHADOW_map 1
#define SHADOW_ray 2
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"
#if SHADOW == SHADOW_map
#include "lib/light_shadow.glsl"
uniform bool pcf;
#elif SHADOW == SHADOW_ray
#include "lib/trace.glsl"
#endif

// Share of the light that reaches x; n is the geometric normal, extent the distance over which x was computed.
float visibility(Light light, vec3 x, vec3 n, float extent) {
#if SHADOW == SHADOW_map
  return light_visibility(light, x, n, pcf);
#elif SHADOW == SHADOW_ray
  vec3 origin = offset_origin(x, n, extent);
  if (int(light.position.w) == LIGHT_DIRECTIONAL) return occluded(origin, -light.direction.xyz, 1e30) ? 0. : 1.;
  // The last hundred-thousandth of the way is free, as it is before a shadow map's near plane: a light may touch a wall.
  return occluded(origin, light.position.xyz - origin, 1. - 1e-5) ? 0. : 1.;
#else
  return 1.;
#endif
}
#endif
