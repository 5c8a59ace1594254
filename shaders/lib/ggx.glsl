// Specular reflection of a rough surface: microfacets after Cook and Torrance (1982) with the GGX distribution (Walter
// et al. 2007), Smith's height-correlated shadowing (Heitz 2014) and Schlick's Fresnel factor (1994):
//   f_s = D·F·G₂/(4 ⟨n,v⟩⟨n,l⟩).
// α is roughness²; F₀ the reflectance along the normal. docs/specular.md; framework/reference/ggx.h is the same in C++.
#ifndef LOOM_LIB_GGX_GLSL
#define LOOM_LIB_GGX_GLSL
#include "interop/ggx.h"
#include "lib/math.glsl"

// Below it a surface is a mirror: its lobe is a direction. Normals in half floats are off by as much.
const float ggx_smooth = 1e-3;

// Reflectance at grazing incidence: 1, but for F₀ under 2 %, which no interface has unless its index is near 1; F₀ = 0
// reflects nothing.
float ggx_f90(vec3 f0) { return min(1., 50. * max(f0.r, max(f0.g, f0.b))); }

// Schlick's approximation; `cosine` between the light and the microfacet's normal.
vec3 fresnel_schlick(float cosine, vec3 f0) {
  float c = clamp(1. - cosine, 0., 1.);
  float c2 = c * c;
  return f0 + (ggx_f90(f0) - f0) * (c2 * c2 * c);
}

// Share of unpolarised light that a smooth dielectric reflects (Fresnel); `eta`: index behind the surface over the
// index in front. 1 where it is reflected totally.
float fresnel_dielectric(float cosine, float eta) {
  float g2 = eta * eta - 1. + cosine * cosine;
  if (g2 <= 0.) return 1.;
  float g = sqrt(g2);
  float s = (cosine - g) / (cosine + g);
  float p = (eta * eta * cosine - g) / (eta * eta * cosine + g);
  return .5 * (s * s + p * p);
}

// The normal of the lobe: a normal map or interpolation may turn n away from v, and it is bent back.
vec3 ggx_facing_normal(vec3 n, vec3 v) {
  const float least = 1e-3;
  float cosine = dot(n, v);
  return cosine >= least ? n : normalize(n + v * (least - cosine));
}

// Distribution of normals h about n, both unit, per steradian.
float ggx_distribution(vec3 n, vec3 h, float alpha) {
  float c = dot(n, h);
  if (c <= 0.) return 0.;
  // 1 − c² as the square of the sine: the difference would lose it where the lobe is narrow.
  vec3 sine = cross(n, h);
  float a2 = alpha * alpha, d = dot(sine, sine) + a2 * c * c;
  return a2 / (pi * d * d);
}

// Smith's Λ of a direction whose cosine with the normal is given.
float ggx_lambda(float cosine, float alpha) {
  float c2 = cosine * cosine;
  return .5 * (sqrt(1. + alpha * alpha * (1. - c2) / max(c2, 1e-12)) - 1.);
}

// f_s/F, 1/sr. v, l: unit, from the surface; zero where either is below it. Not for mirrors (α < ggx_smooth).
float ggx_microfacets(vec3 n, vec3 v, vec3 l, float alpha) {
  float mu_v = dot(n, v), mu_l = dot(n, l);
  if (mu_v <= 0. || mu_l <= 0.) return 0.;
  float g2 = 1. / (1. + ggx_lambda(mu_v, alpha) + ggx_lambda(mu_l, alpha));
  return ggx_distribution(n, normalize(v + l), alpha) * g2 / (4. * mu_v * mu_l);
}

// f_s, 1/sr.
vec3 ggx_brdf(vec3 n, vec3 v, vec3 l, float alpha, vec3 f0) {
  return fresnel_schlick(dot(v, normalize(v + l)), f0) * ggx_microfacets(n, v, l, alpha);
}

// A normal that v sees, by the distribution of visible normals (Heitz 2018). The direction of light is reflect(−v, h);
// its density is D·G₁/(4 ⟨n,v⟩), so that f_s·⟨n,l⟩ over the density is F·G₂/G₁ (ggx_sample_weight).
vec3 ggx_sample_normal(vec3 n, vec3 v, float alpha, vec2 u) {
  mat3 basis = orthonormal_basis(n);
  vec3 local = v * basis;
  vec3 stretched = normalize(vec3(alpha * local.xy, local.z));
  vec3 t = normalize_or(vec3(-stretched.y, stretched.x, 0), vec3(1, 0, 0));
  vec3 b = cross(stretched, t);
  float r = sqrt(u.x), phi = 2. * pi * u.y;
  float p = r * cos(phi), s = .5 * (1. + stretched.z);
  float q = mix(sqrt(1. - p * p), r * sin(phi), s);
  vec3 h = p * t + q * b + sqrt(max(0., 1. - p * p - q * q)) * stretched;
  return basis * normalize(vec3(alpha * h.xy, max(1e-6, h.z)));
}

// F·G₂/G₁ of a direction found by ggx_sample_normal; h between v and l.
vec3 ggx_sample_weight(vec3 n, vec3 v, vec3 l, vec3 h, float alpha, vec3 f0) {
  float mu_v = dot(n, v), mu_l = dot(n, l);
  if (mu_v <= 0. || mu_l <= 0.) return vec3(0);
  float lambda_v = ggx_lambda(mu_v, alpha);
  return fresnel_schlick(dot(v, h), f0) * ((1. + lambda_v) / (1. + lambda_v + ggx_lambda(mu_l, alpha)));
}

// Directional albedo E(μ) = ∫ f_s ⟨n,l⟩ dω of a view at cosine μ, from a table (its error: docs/specular.md).
vec3 ggx_albedo(float mu, float alpha, vec3 f0) {
  const int side = GGX_TABLE_SIDE;
  vec2 at = sqrt(clamp(vec2(mu, alpha), 0., 1.)) * float(side - 1);
  ivec2 cell = min(ivec2(at), side - 2);
  vec2 f = at - vec2(cell);
  int i = 2 * (cell.x * side + cell.y);
  vec2 lower = mix(vec2(ggx_table[i], ggx_table[i + 1]), vec2(ggx_table[i + 2], ggx_table[i + 3]), f.y);
  i += 2 * side;
  vec2 upper = mix(vec2(ggx_table[i], ggx_table[i + 1]), vec2(ggx_table[i + 2], ggx_table[i + 3]), f.y);
  vec2 split = mix(lower, upper, f.x);
  return f0 * split.x + ggx_f90(f0) * split.y;
}
#endif
