// L(v) = Σ f_s(v, l) ⟨n,l⟩₊ I(ω)/r² V
#include "interop/camera.h"
#include "lib/camera.glsl"
#include "lib/ggx.glsl"
#include "lib/punctual_shadow.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_normal;
uniform sampler2D surface_geometric_normal;
uniform sampler2D surface_specular;
#if GLASS
uniform sampler2D surface_transmission;
#endif
writeonly uniform image2D radiance_image;

// Share of light about the microfacet normal that is reflected: by the coat, or where the surface is glass, by glass.
vec3 reflected_share(ivec2 pixel, float cosine, vec3 f0) {
  vec3 coat = fresnel_schlick(cosine, f0);
#if GLASS
  vec2 glass = texelFetch(surface_transmission, pixel, 0).rg;
  return mix(coat, vec3(fresnel_dielectric(cosine, glass.g)), glass.r);
#else
  return coat;
#endif
}

vec3 radiance_of(ivec2 pixel, float depth) {
  vec4 specular = texelFetch(surface_specular, pixel, 0);
  float alpha = specular.a;
  // A mirror shows a light that is a point, or comes from one direction, nowhere.
  if (alpha < ggx_smooth || specular.rgb == vec3(0)) return vec3(0);
  vec2 uv = pixel_uv(camera, pixel);
  vec3 x = surface_position(camera, uv, depth), v = -ray_direction(camera, uv);
  vec3 n = normalize(texelFetch(surface_normal, pixel, 0).xyz);
  vec3 n_g = normalize(texelFetch(surface_geometric_normal, pixel, 0).xyz);
  vec3 n_lobe = ggx_facing_normal(n, v);
  vec3 radiance = vec3(0);
  for (int i = 0; i < lights.length(); ++i) {
    vec3 l;
    vec3 arriving = light_irradiance(lights[i], x, l);
    float cosine = dot(n, l);
    if (cosine <= 0. || dot(n_g, l) <= 0. || arriving == vec3(0)) continue;
    float f = ggx_microfacets(n_lobe, v, l, alpha);
    vec3 h = normalize(v + l);
    radiance += arriving * cosine * f * reflected_share(pixel, dot(v, h), specular.rgb) *
                visibility(lights[i], x, n_g, depth);
  }
  return radiance;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radiance_image)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  imageStore(radiance_image, pixel, vec4(depth > 0. ? radiance_of(pixel, depth) : vec3(0), 1));
}
