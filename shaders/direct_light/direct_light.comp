// E(x) = Σ I(ω)/r² ⟨n,l⟩₊ V
#define SHADOW_none 0
#define SHADOW_map 1
#define SHADOW_ray 2
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/rsm.glsl"
#include "lib/scene_lights.glsl"
#if SHADOW == SHADOW_map
#include "lib/light_shadow.glsl"
uniform bool pcf;
#elif SHADOW == SHADOW_ray
#include "lib/trace.glsl"
#endif
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
writeonly uniform image2D irradiance_irradiance;

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

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(irradiance_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 irradiance = vec3(0);
  if (depth > 0.) {
    vec3 x = surface_position(camera, pixel_uv(camera, pixel), depth);
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
    for (int i = 0; i < lights.length(); ++i) {
      vec3 l;
      vec3 arriving = light_irradiance(lights[i], x, l);
      float cosine = dot(n, l);
      if (cosine <= 0. || dot(n_g, l) <= 0. || arriving == vec3(0)) continue;
      irradiance += arriving * cosine * visibility(lights[i], x, n_g, depth);
    }
  }
  imageStore(irradiance_irradiance, pixel, vec4(irradiance, 1));
}
