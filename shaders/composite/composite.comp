// L = L_e + ρ/π · (1 − E(μ)) · (E_direct + E_indirect) + L_s; the sky where depth is 0.
#include "lib/math.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
#if SKY
#include "interop/frame.h"
#include "lib/sky.glsl"
layout(std140) uniform frame_data { FrameData frame; };
#endif
#if COAT || (SKY && SCENE_SKY_IMAGE)
#include "interop/camera.h"
#include "lib/camera.glsl"
layout(std140) uniform surface_data { Camera camera; };
#endif
#if COAT
#include "lib/ggx.glsl"
uniform sampler2D surface_normal;
uniform sampler2D surface_specular;
#endif
#if SPECULAR
uniform sampler2D specular_image;
#endif
uniform sampler2D surface_depth;
uniform sampler2D surface_albedo;
#if EMISSION
uniform sampler2D surface_emission;
#endif
#if DIRECT
uniform sampler2D direct_irradiance;
#endif
#if INDIRECT
uniform sampler2D indirect_irradiance;
#endif
writeonly uniform image2D radiance_image;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radiance_image)))) return;
#if SKY
#if SCENE_SKY_IMAGE
  // At the middle of a picture in perspective a pixel is so large; an orthographic one sees one direction.
  vec2 side = 2. * vec2(length(camera.right.xyz), length(camera.up.xyz)) * camera.size.zw;
  vec3 radiance = sky_radiance(frame.sky, ray_direction(camera, pixel_uv(camera, pixel)),
                               is_orthographic(camera) ? 0. : side.x * side.y);
#else
  vec3 radiance = frame.sky.rgb;
#endif
#else
  vec3 radiance = vec3(0);
#endif
  if (texelFetch(surface_depth, pixel, 0).r > 0) {
    vec3 irradiance = vec3(0);
#if DIRECT
    irradiance += texelFetch(direct_irradiance, pixel, 0).rgb;
#endif
#if INDIRECT
    irradiance += texelFetch(indirect_irradiance, pixel, 0).rgb;
#endif
    radiance = texelFetch(surface_albedo, pixel, 0).rgb * irradiance / pi;
#if COAT
    vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
    vec4 specular = texelFetch(surface_specular, pixel, 0);
    float mu = max(0., -dot(n, ray_direction(camera, pixel_uv(camera, pixel))));
    radiance *= 1. - ggx_albedo(mu, specular.a, specular.rgb);
#endif
#if SPECULAR
    radiance += texelFetch(specular_image, pixel, 0).rgb;
#endif
#if EMISSION
    radiance += texelFetch(surface_emission, pixel, 0).rgb;
#endif
  }
  imageStore(radiance_image, pixel, vec4(radiance, 1));
}
