// L_t = τ/N Σ (1−F)·c·L_inside: in through the surface that is seen, and out wherever the ray meets it from within.
#include "reflections/rays.glsl"
#include "lib/trace.glsl"
uniform int bounces;

// What arrives along a ray within glass of index `ior`, from a point of its surface with the geometric normal n_g
// (outwards) that was found over `extent`: at each meeting the share (1−F) leaves, and F is reflected and goes on.
vec3 from_inside(vec3 x, vec3 w, vec3 n_g, float ior, float extent, float within) {
  vec3 sum = vec3(0), weight = vec3(1), inwards = -n_g;
  for (int k = 0; k < bounces; ++k) {
    Hit hit = closest_hit(offset_origin(x, inwards, extent), w, no_hit);
    // Glass without a back: a single sheet.
    if (!is_hit(hit)) return sum + weight * seen_along(x, w, vec3(0), extent, within);
    x = hit_position(hit);
    extent += hit.t;
    inwards = hit_normal(hit);
    if (dot(inwards, w) > 0.) inwards = -inwards;
    Material material = materials[hit_material(hit)];
    // Something else within: as the picture or the voxels show it from just before.
    if (material.factors.w <= .5) return sum + weight * seen_along(x - 1e-3 * hit.t * w, w, vec3(0), extent, within);
    float cosine = -dot(w, inwards), reflected = fresnel_dielectric(cosine, 1. / ior);
    vec3 out_of = refract(w, inwards, ior);
    if (reflected < 1. && out_of != vec3(0)) {
      vec3 through = material.base_color.rgb * (1. - reflected);
      sum += weight * through * seen_along(x, out_of, -inwards, extent, within);
    }
    weight *= reflected;
    if (reflected < 1. / 256.) break;  // at most so much of what is within is left out
    w = reflect(w, inwards);
  }
  return sum;
}

// Mean over the rays of this part.
vec3 radiance_at(ivec2 pixel, float depth) {
  vec2 glass = glass_at(pixel);
  if (glass.x <= 0.) return vec3(0);
  Surface at = surface_at(pixel, depth);
  float alpha = texelFetch(surface_specular, pixel, 0).a;
  bool smooth_glass = alpha < ggx_smooth;
  uint seed = pixel_seed(uvec2(pixel), uvec4(frame.random.xy, 0u, 0u), 0x72656672u);
  int count = smooth_glass ? 1 : samples_of_part(samples);
  // The first surface's colour is that of its material, which the ray finds again from just in front of it.
  Hit self = closest_hit(at.x + 1e-3 * depth * at.v, -at.v, 2e-3 * depth);
  vec3 colour = is_hit(self) ? materials[hit_material(self)].base_color.rgb : vec3(1);
  vec3 sum = vec3(0);
  for (int k = 0; k < count; ++k) {
    uint i = stretch_of_part(frame.random.z) * uint(count) + uint(k);
    vec3 h = smooth_glass ? at.n : ggx_sample_normal(at.n, at.v, alpha, low_discrepancy(i, seed));
    vec3 w = refract(-at.v, h, 1. / glass.y);
    if (w == vec3(0) || dot(w, at.n_g) >= 0. || dot(w, at.n) >= 0.) continue;
    float through = 1. - fresnel_dielectric(dot(at.v, h), glass.y);
    // Each side shadowed on its own (Walter et al. 2007): G₂/G₁ is G₁ of the way in.
    if (!smooth_glass) through /= 1. + ggx_lambda(-dot(w, at.n), alpha);
    float within = smooth_glass ? .5 : to_unit(hash(uvec4(seed, i, 3u, 0u)).x);
    sum += through * from_inside(at.x, w, at.n_g, glass.y, depth, within);
  }
  return glass.x * colour * sum / float(count);
}

#include "reflections/main.glsl"
