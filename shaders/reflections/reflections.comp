// L_s = 1/N Σ L(l_i)·F·G₂/G₁, l_i reflected at normals that the view sees.
#include "reflections/rays.glsl"

// Share of light about a microfacet's normal that is reflected. glass: its share τ of the surface, and its index.
vec3 fresnel(float cosine, vec3 f0, vec2 glass) {
  return mix(fresnel_schlick(cosine, f0), vec3(fresnel_dielectric(cosine, glass.y)), glass.x);
}

// G₂/G₁ of a direction of light, of which the view has seen the microfacet.
float shadowing(float mu_v, float mu_l, float alpha) {
  if (mu_v <= 0. || mu_l <= 0.) return 0.;
  float lambda_v = ggx_lambda(mu_v, alpha);
  return (1. + lambda_v) / (1. + lambda_v + ggx_lambda(mu_l, alpha));
}

// Mean over the rays of this part.
vec3 radiance_at(ivec2 pixel, float depth) {
  vec4 specular = texelFetch(surface_specular, pixel, 0);
  if (specular.rgb == vec3(0)) return vec3(0);
  Surface at = surface_at(pixel, depth);
  vec3 v = at.v, x = at.x, n = at.n, n_g = at.n_g;
  vec2 glass = glass_at(pixel);
  bool mirror = specular.a < ggx_smooth;
  uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x7265666cu);
  int count = mirror ? 1 : samples_of_part(samples);
  vec3 sum = vec3(0);
  for (int k = 0; k < count; ++k) {
    uint i = stretch_of_part(frame.random.z) * uint(count) + uint(k);
    vec3 h = mirror ? n : ggx_sample_normal(n, v, specular.a, low_discrepancy(i, seed));
    vec3 l = reflect(-v, h);
    vec3 weight = fresnel(dot(v, h), specular.rgb, glass);
    if (!mirror) weight *= shadowing(dot(n, v), dot(n, l), specular.a);
    // Below the surface there is no light; a shading normal may lead there.
    if (weight == vec3(0) || dot(l, n_g) <= 0.) continue;
    sum += weight * seen_along(x, l, n_g, depth, mirror ? .5 : to_unit(hash(uvec4(seed, i, 3u, 0u)).x));
  }
  return sum / float(count);
}

#include "reflections/main.glsl"
