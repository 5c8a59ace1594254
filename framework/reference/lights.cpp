#include "reference/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/weights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
/// Barycentric lattice on which textured emission is averaged: only the choice of triangles depends on it.
constexpr int lattice = 8;
/// An emissive triangle whose texture looks black on the lattice still gets this share of its factor's power.
constexpr float least_texture = 1e-3F;
/// Cosine sampling finds the sky by itself wherever it is open; light samples go to triangles first.
constexpr float most_sky = .25F;
/// Of the way to a punctual light: a light may touch a wall, as it may in the passes.
constexpr float way_to_light = 1 - 1e-5F;

/// A point of the unit square to barycentrics, area-preserving and nearly distance-preserving (Heitz 2019).
glm::vec2 square_to_triangle(glm::vec2 u) {
  if (u.y > u.x) {
    u.x *= .5F;
    u.y -= u.x;
  } else {
    u.y *= .5F;
    u.x -= u.y;
  }
  return u;
}

}  // namespace

glm::vec3 sample_cosine(const glm::vec3& normal, glm::vec2 u) {
  const float a = 2 * u.x - 1;
  const float b = 2 * u.y - 1;
  float r = 0, phi = 0;
  if (std::abs(a) > std::abs(b)) {
    r = a;
    phi = pi / 4 * (b / a);
  } else if (b != 0) {
    r = b;
    phi = pi / 2 - pi / 4 * (a / b);
  }
  const float x = r * std::cos(phi);
  const float y = r * std::sin(phi);
  const float z = std::sqrt(std::max(0.F, 1 - r * r));
  // Basis about the normal without a branch on its axis (Duff et al. 2017).
  const float sign = std::copysign(1.F, normal.z);
  const float c = -1 / (sign + normal.z);
  const float d = normal.x * normal.y * c;
  const glm::vec3 s(1 + sign * normal.x * normal.x * c, sign * d, -sign * normal.x);
  const glm::vec3 t(d, sign + normal.y * normal.y * c, -normal.y);
  return glm::normalize(s * x + t * y + normal * z);
}

Lights::Lights(const scene::Scene& scene, EmbreeScene& geometry, const glm::dvec3& origin)
    : geometry_(geometry), sky_(scene) {
  for (const auto& light : scene.lights) {
    if (largest(light.intensity) <= 0) continue;
    const double cos_outer = std::cos(light.outer_rad);
    // KHR_lights_punctual: the bound keeps the falloff finite for a hard edge.
    const double range = std::max(.001, std::cos(light.inner_rad) - cos_outer);
    punctual_.push_back({light.kind, glm::vec3(light.position - origin), glm::vec3(light.direction), light.intensity,
                         static_cast<float>(cos_outer), static_cast<float>(1 / range)});
  }
  for (std::size_t i = 0; i < geometry.geometries().size(); ++i) {
    add_emitters(geometry.geometries()[i], static_cast<std::uint32_t>(i));
  }
  choose_by_power(largest(scene.sky) > 0);
}

void Lights::add_emitters(Geometry& geometry, std::uint32_t index) {
  const scene::Material& material = *geometry.material;
  if (largest(material.emissive) <= 0) return;
  geometry.first_emitter = static_cast<int>(emitters_.size());
  const auto triangles = static_cast<std::uint32_t>(geometry.primitive->indices.size() / 3);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    Emitter emitter{.triangle = {.geometry = index, .triangle = t, .uv = glm::vec2(0)}};
    glm::vec3 a, b, c;
    geometry_.corners(emitter.triangle, a, b, c);
    emitter.area = glm::length(glm::cross(b - a, c - a)) / 2;
    float radiance = mean(material.emissive);
    if (geometry.textured) {
      float sum = 0;
      for (int i = 0; i < lattice * lattice; ++i) {
        const glm::vec2 u((static_cast<float>(i % lattice) + .5F) / lattice,
                          (static_cast<float>(i / lattice) + .5F) / lattice);
        TrianglePoint at = emitter.triangle;
        at.uv = square_to_triangle(u);
        sum += mean(geometry_.emission(at));
      }
      radiance = std::max(sum / (lattice * lattice), least_texture * radiance);
    }
    emitter.probability = emitter.area * radiance * (material.double_sided ? 2.F : 1.F);
    if (!std::isfinite(emitter.probability)) emitter.probability = 0;
    emitters_.push_back(emitter);
  }
}

void Lights::choose_by_power(bool sky) {
  double total = 0;
  for (const auto& emitter : emitters_) total += emitter.probability;
  if (sky) sky_share_ = total > 0 ? most_sky : 1;
  if (total <= 0) return;
  double sum = 0;
  for (auto& emitter : emitters_) {
    sum += emitter.probability;
    emitter.probability = static_cast<float>(emitter.probability / total) * (1 - sky_share_);
    cumulative_.push_back(static_cast<float>(sum / total));
  }
}

glm::vec3 Lights::irradiance(const Punctual& light, const SurfacePoint& at, glm::vec3& direction, float& distance) {
  glm::vec3 strength = light.intensity;
  if (light.kind == scene::LightKind::directional) {
    direction = -light.direction;
    distance = std::numeric_limits<float>::infinity();
  } else {
    const glm::vec3 way = light.position - at.start();
    const float squared = glm::dot(way, way);
    if (!(squared > 0)) return glm::vec3(0);
    distance = std::sqrt(squared);
    direction = way / distance;
    distance *= way_to_light;
    strength /= squared;
    if (light.kind == scene::LightKind::spot) {
      const float cosine = -glm::dot(light.direction, direction);
      const float falloff = glm::clamp((cosine - light.cos_outer) * light.inverse_range, 0.F, 1.F);
      strength *= falloff * falloff;
    }
  }
  if (glm::dot(at.geometric_normal, direction) <= 0) return glm::vec3(0);
  return strength * std::max(0.F, glm::dot(at.normal, direction));
}

LightSample Lights::sample_punctual(const SurfacePoint& at, float u) const {
  LightSample chosen;
  float total = 0;
  for (const auto& light : punctual_) {
    LightSample candidate;
    candidate.value = irradiance(light, at, candidate.direction, candidate.distance);
    const float weight = mean(candidate.value);
    if (!(weight > 0)) continue;
    total += weight;
    // Keeps each with probability weight/total of those seen so far; what is left of u serves the next choice.
    const float share = weight / total;
    if (u < share) {
      u /= share;
      chosen = candidate;
      chosen.density = weight;
    } else {
      u = (u - share) / (1 - share);
    }
  }
  if (chosen.density > 0) chosen.value *= total / chosen.density;
  return chosen;
}

LightSample Lights::sample_emitter(const SurfacePoint& at, glm::vec2 u) const {
  LightSample s;
  if (u.x < sky_share_) {
    u.x /= sky_share_;
    s.direction = sky_.directed() ? sky_.sample(u) : sample_cosine(at.normal, u);
    s.density = sky_density(at, s.direction);
    s.distance = std::numeric_limits<float>::infinity();
    s.value = sky_.radiance(s.direction);
    return s;
  }
  if (cumulative_.empty()) return s;
  u.x = (u.x - sky_share_) / (1 - sky_share_);
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u.x);
  const auto i = static_cast<std::size_t>(
      std::min(found - cumulative_.begin(), static_cast<std::ptrdiff_t>(cumulative_.size()) - 1));
  const Emitter& emitter = emitters_[i];
  if (!(emitter.probability > 0)) return s;
  const float below = i == 0 ? 0 : cumulative_[i - 1];
  u.x = std::min((u.x - below) / (cumulative_[i] - below), 0x1.fffffep-1F);

  TrianglePoint point = emitter.triangle;
  point.uv = square_to_triangle(u);
  glm::vec3 a, b, c;
  geometry_.corners(point, a, b, c);
  const Geometry& g = geometry_.geometries()[point.geometry];
  const glm::vec3 front = glm::cross(b - a, c - a) * (g.orientation / (2 * emitter.area));
  glm::vec3 target = a + point.uv.x * (b - a) + point.uv.y * (c - a);
  const float facing = glm::dot(front, at.position - target);
  if (facing == 0 || (facing < 0 && !g.material->double_sided)) return s;
  target += front * std::copysign(EmbreeScene::offset(a, b, c), facing);
  const glm::vec3 way = target - at.start();  // a ray from elsewhere would end behind the emitter
  const float squared = glm::dot(way, way);
  s.distance = std::sqrt(squared);
  if (!(s.distance > 0)) return s;
  s.direction = way / s.distance;
  const float cosine = std::abs(glm::dot(front, s.direction));
  s.value = geometry_.emission(point);
  s.density = cosine > 0 ? emitter.probability * squared / (emitter.area * cosine) : 0;
  return s;
}

float Lights::density(const glm::vec3& from, const SurfacePoint& point, const glm::vec3& direction) const {
  if (point.emitter < 0) return 0;
  const Emitter& emitter = emitters_[static_cast<std::size_t>(point.emitter)];
  const glm::vec3 way = point.position - from;
  const float cosine = std::abs(glm::dot(point.geometric_normal, direction));
  return cosine > 0 ? emitter.probability * glm::dot(way, way) / (emitter.area * cosine) : 0;
}

float Lights::sky_density(const SurfacePoint& from, const glm::vec3& direction) const {
  // Light samples from below the surface are thrown away: what glass lets through finds the sky by itself.
  const bool above = glm::dot(from.normal, direction) > 0 && glm::dot(from.geometric_normal, direction) > 0;
  if (sky_.directed()) return above ? sky_share_ * sky_.density(direction) : 0;
  return sky_share_ * std::max(0.F, glm::dot(from.normal, direction)) / pi;
}

}  // namespace loom::reference
