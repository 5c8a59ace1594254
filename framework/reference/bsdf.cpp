#include "reference/bsdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/ggx.h"
#include "reference/lights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
/// A normal map or interpolation may turn the normal away from the viewer; the lobe's is bent back to this cosine.
constexpr float least_view = 1e-3F;

/// Tangents of a unit normal, and the normal (Duff et al. 2017).
glm::mat3 frame_of(const glm::vec3& n) {
  const float s = std::copysign(1.F, n.z);
  const float a = -1 / (s + n.z);
  const float b = n.x * n.y * a;
  return {glm::vec3(1 + s * n.x * n.x * a, s * b, -s * n.x), glm::vec3(b, s + n.y * n.y * a, -n.y), n};
}

}  // namespace

Bsdf::Bsdf(const SurfacePoint& at, const glm::vec3& to_viewer) : at_(at), to_viewer_(to_viewer) {
  if (!at.glossy) return;
  const float cosine = glm::dot(at.normal, to_viewer);
  const glm::vec3 normal =
      cosine >= least_view ? at.normal : glm::normalize(at.normal + to_viewer * (least_view - cosine));
  frame_ = frame_of(normal);
  view_ = to_viewer * frame_;
  view_.z = std::max(view_.z, least_view / 2);
  albedo_ = ggx_albedo(view_.z, at.alpha, at.f0);
  glass_ = at.transmission;
  eta_ = at.inside ? 1 / at.ior : at.ior;
}

bool Bsdf::mirror() const { return at_.alpha < ggx_smooth; }

glm::vec3 Bsdf::diffuse(const glm::vec3& direction) const {
  const glm::vec3 lambert = at_.albedo / pi;
  if (!at_.glossy || at_.albedo == glm::vec3(0)) return lambert;
  const float mu_l = std::max(0.F, glm::dot(at_.normal, direction));
  const glm::vec3 through = (1.F - albedo_) * (1.F - ggx_albedo(mu_l, at_.alpha, at_.f0));
  return lambert * through / glm::max(1.F - ggx_mean_albedo(at_.alpha, at_.f0), 1e-4F);
}

glm::vec3 Bsdf::fresnel(float cosine) const {
  const glm::vec3 coat = fresnel_schlick(cosine, at_.f0) * (1 - glass_);
  return glass_ > 0 ? coat + glass_ * fresnel_dielectric(cosine, eta_) : coat;
}

float Bsdf::reflects(float cosine) const {
  return glass_ > 0 ? 1 - glass_ + glass_ * fresnel_dielectric(cosine, eta_) : 1;
}

float Bsdf::specular_share(Lobes lobes) const {
  if (!at_.glossy || lobes == Lobes::diffuse) return 0;
  if (lobes == Lobes::specular || at_.albedo == glm::vec3(0)) return 1;
  const float specular = mean(albedo_) * (1 - glass_) + glass_;
  const float diffuse = mean(at_.albedo * (1.F - albedo_));
  return specular / std::max(specular + diffuse, 1e-6F);
}

glm::vec3 Bsdf::evaluate(const glm::vec3& direction, Lobes lobes) const {
  glm::vec3 f(0);
  if (lobes != Lobes::specular) f += diffuse(direction);
  if (lobes == Lobes::diffuse || !at_.glossy || mirror()) return f;
  const glm::vec3 light = direction * frame_;
  if (light.z <= 0) return f;
  const glm::vec3 h = glm::normalize(view_ + light);
  const float rest = ggx_distribution(h, at_.alpha) * ggx_shadowing(view_.z, light.z, at_.alpha);
  return f + fresnel(glm::dot(view_, h)) * (rest / (4 * view_.z * light.z));
}

float Bsdf::density(const glm::vec3& direction, Lobes lobes) const {
  const float share = specular_share(lobes);
  float density = (1 - share) * std::max(0.F, glm::dot(at_.normal, direction)) / pi;
  if (share == 0 || mirror()) return density;
  const glm::vec3 light = direction * frame_;
  if (light.z <= 0) return density;
  const glm::vec3 h = glm::normalize(view_ + light);
  return density + share * reflects(glm::dot(view_, h)) * ggx_sample_density(view_, h, at_.alpha);
}

BsdfSample Bsdf::sample(Lobes lobes, glm::vec2 u, glm::vec2 choice) const {
  const float share = specular_share(lobes);
  BsdfSample s;
  if (choice.x < share) {
    s = sample_specular(u, choice.y);
    if (s.density == 0) s.weight /= share;
  } else {
    s.direction = sample_cosine(at_.normal, u);
    s.density = 1;
  }
  if (s.weight == glm::vec3(0) && s.density == 0) return s;
  // The side of the triangle that the direction leaves must be the one that it was meant for.
  const bool above = glm::dot(at_.geometric_normal, s.direction) > 0;
  if (s.density == 0) {
    const bool refracted = glm::dot(frame_[2], s.direction) < 0;
    if (above == refracted) s.weight = glm::vec3(0);
    return s;
  }
  // With both ways of finding it: one-sample estimate by the mixture's density.
  s.density = density(s.direction, lobes);
  const float cosine = glm::dot(at_.normal, s.direction);
  if (!above || cosine <= 0 || !(s.density > 0)) return {};
  s.weight = evaluate(s.direction, lobes) * (cosine / s.density);
  return s;
}

// f is symmetric but for n² of glass, which is radiance's and not flux's. A path's weight has the cosine of the shading
// normal n where it leaves; flux, Φ = ∫ L⟨n_g,ω⟩, has n's where it arrives and n_g's where it leaves (Veach 1997, 5.3):
//   Φ'/Φ = weight · ⟨n,in⟩/⟨n_g,in⟩ · ⟨n_g,out⟩/⟨n,out⟩ (· η² where it is refracted).
FluxSample Bsdf::sample_flux(glm::vec2 u, glm::vec2 choice) const {
  const float share = specular_share(Lobes::all);
  const bool specular = choice.x < share;
  const BsdfSample s = sample(specular ? Lobes::specular : Lobes::diffuse, u, choice);
  const float in = glm::dot(at_.normal, to_viewer_);
  if (s.weight == glm::vec3(0) || in <= 0) return {};
  const float in_plane = glm::dot(at_.geometric_normal, to_viewer_);
  const float out = glm::dot(at_.normal, s.direction), out_plane = glm::dot(at_.geometric_normal, s.direction);
  const float turned = in * std::abs(out_plane) / (std::max(1e-3F, in_plane) * std::max(1e-3F, std::abs(out)));
  const float index = out_plane < 0 ? eta_ * eta_ : 1;
  return {s.direction, s.weight * (turned * index / (specular ? share : 1 - share)), specular};
}

BsdfSample Bsdf::sample_specular(glm::vec2 u, float choice) const {
  const float alpha = mirror() ? 0 : at_.alpha;
  const glm::vec3 h = ggx_sample_normal(view_, alpha, u);
  const float cosine = glm::dot(view_, h);
  const float reflected = reflects(cosine);
  BsdfSample s;
  if (choice < reflected) {
    const glm::vec3 light = 2 * cosine * h - view_;
    s.direction = glm::normalize(frame_ * light);
    if (light.z <= 0) return s;
    if (mirror()) {
      s.weight = fresnel(cosine) / reflected;
    } else {
      s.density = 1;  // sample() has the true one
    }
    return s;
  }
  // Snell: the tangent part shrinks by eta. There is a direction, or all would have been reflected.
  const float sine2 = (1 - cosine * cosine) / (eta_ * eta_);
  const float inner = std::sqrt(std::max(0.F, 1 - sine2));
  const glm::vec3 light = (cosine / eta_ - inner) * h - view_ / eta_;
  s.direction = glm::normalize(frame_ * light);
  if (light.z >= 0) return s;
  // Radiance within a medium is n² of that outside. G₂/G₁ with both sides shadowed on their own, as Walter has it.
  s.weight = at_.base_color * (1 / (eta_ * eta_));
  if (alpha > 0) s.weight /= 1 + ggx_lambda(-light.z, alpha);
  return s;
}

}  // namespace loom::reference
