#pragma once
// Specular reflection of a rough surface in a frame whose z is its normal: GGX (Walter et al. 2007) with Smith's
// height-correlated shadowing (Heitz 2014) and Schlick's Fresnel factor (1994). shaders/lib/ggx.glsl is the same.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "interop/ggx.h"
#include "loom/export.h"

namespace loom::reference {

/// α below which a surface is a mirror.
inline constexpr float ggx_smooth = 1e-3F;

/// Reflectance at grazing incidence: 1, but for F₀ under 2 %, which no interface has unless its index is near 1.
inline float ggx_f90(const glm::vec3& f0) { return std::min(1.F, 50 * std::max(f0.x, std::max(f0.y, f0.z))); }

inline glm::vec3 fresnel_schlick(float cosine, const glm::vec3& f0) {
  const float c = std::clamp(1 - cosine, 0.F, 1.F);
  const float c2 = c * c;
  return f0 + (ggx_f90(f0) - f0) * (c2 * c2 * c);
}

/// Share of unpolarised light that a smooth dielectric reflects; `eta`: index behind the surface over that in front.
/// 1 where it is reflected totally.
inline float fresnel_dielectric(float cosine, float eta) {
  const float g2 = eta * eta - 1 + cosine * cosine;
  if (g2 <= 0) return 1;
  const float g = std::sqrt(g2);
  const float s = (cosine - g) / (cosine + g);
  const float p = (eta * eta * cosine - g) / (eta * eta * cosine + g);
  return (s * s + p * p) / 2;
}

/// Density of normals `h` (unit), per steradian.
inline float ggx_distribution(const glm::vec3& h, float alpha) {
  if (h.z <= 0) return 0;
  const float a2 = alpha * alpha;
  const float d = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
  return a2 / (std::numbers::pi_v<float> * d * d);
}

inline float ggx_lambda(float cosine, float alpha) {
  const float c2 = cosine * cosine;
  return (std::sqrt(1 + alpha * alpha * (1 - c2) / std::max(c2, 1e-12F)) - 1) / 2;
}

/// G₂ of a view and a light at these cosines, both above the surface.
inline float ggx_shadowing(float mu_v, float mu_l, float alpha) {
  return 1 / (1 + ggx_lambda(mu_v, alpha) + ggx_lambda(mu_l, alpha));
}

/// A normal that `v` (unit, v.z > 0) sees, with density G₁·D·⟨v,h⟩/v.z (Heitz 2018). α = 0 gives (0, 0, 1).
inline glm::vec3 ggx_sample_normal(const glm::vec3& v, float alpha, glm::vec2 u) {
  const glm::vec3 stretched = glm::normalize(glm::vec3(alpha * v.x, alpha * v.y, v.z));
  const float across = stretched.x * stretched.x + stretched.y * stretched.y;
  const glm::vec3 t = across > 0 ? glm::vec3(-stretched.y, stretched.x, 0) / std::sqrt(across) : glm::vec3(1, 0, 0);
  const glm::vec3 b = glm::cross(stretched, t);
  const float r = std::sqrt(u.x), phi = 2 * std::numbers::pi_v<float> * u.y;
  const float p = r * std::cos(phi), s = (1 + stretched.z) / 2;
  const float q = (1 - s) * std::sqrt(std::max(0.F, 1 - p * p)) + s * r * std::sin(phi);
  const glm::vec3 h = p * t + q * b + std::sqrt(std::max(0.F, 1 - p * p - q * q)) * stretched;
  return glm::normalize(glm::vec3(alpha * h.x, alpha * h.y, std::max(1e-6F, h.z)));
}

/// The density, per steradian, of the direction that a normal found so reflects `v` to.
inline float ggx_sample_density(const glm::vec3& v, const glm::vec3& h, float alpha) {
  return ggx_distribution(h, alpha) / (4 * v.z * (1 + ggx_lambda(v.z, alpha)));
}

/// Directional albedo E(μ) = ∫ f_s ⟨n,l⟩ dω, from the table that shaders have (docs/specular.md).
LOOM_API glm::vec3 ggx_albedo(float mu, float alpha, const glm::vec3& f0);
/// Its mean over the hemisphere, 2∫ E μ dμ.
LOOM_API glm::vec3 ggx_mean_albedo(float alpha, const glm::vec3& f0);

}  // namespace loom::reference
