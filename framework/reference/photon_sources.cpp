// Flux of the photons that begin at a source chosen with probability p:
//   point, spot   I(ω)·Ω/p           emissive triangle   π·L·A/p (both sides: twice)
//   directional   E⊥·πR²/p           sky                 L·4π·πR²/p,   R the radius of the scene's sphere
#include "reference/photon_sources.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/lights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

glm::vec3 on_sphere(glm::vec2 u, float least_z) {
  const float z = 1 - u.x * (1 - least_z);
  const float r = std::sqrt(std::max(0.F, 1 - z * z));
  return {r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z};
}

/// `local` with its z axis turned to `axis`.
glm::vec3 turned(const glm::vec3& local, const glm::vec3& axis) {
  const glm::vec3 side = std::abs(axis.x) < .5F ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 s = glm::normalize(glm::cross(side, axis));
  return s * local.x + glm::cross(axis, s) * local.y + axis * local.z;
}

}  // namespace

PhotonSources::PhotonSources(const scene::Scene& scene, const EmbreeScene& geometry, const glm::dvec3& origin)
    : geometry_(geometry), sky_(scene) {
  low_ = glm::vec3(std::numeric_limits<float>::max());
  high_ = -low_;
  const auto count = static_cast<std::uint32_t>(geometry.geometries().size());
  for (std::uint32_t g = 0; g < count; ++g) {
    const Geometry& part = geometry.geometries()[g];
    for (std::uint32_t t = 0; t < part.primitive->indices.size() / 3; ++t) {
      Source source{.kind = Kind::triangle, .triangle = {.geometry = g, .triangle = t, .uv = glm::vec2(0)}};
      glm::vec3 a, b, c;
      geometry.corners(source.triangle, a, b, c);
      low_ = glm::min(low_, glm::min(a, glm::min(b, c)));
      high_ = glm::max(high_, glm::max(a, glm::max(b, c)));
      const float emitted = mean(part.material->emissive);
      if (emitted <= 0) continue;
      source.area = glm::length(glm::cross(b - a, c - a)) / 2;
      add(source, pi * emitted * source.area * (part.material->double_sided ? 2 : 1));
    }
  }
  if (count == 0) low_ = high_ = glm::vec3(0);
  diagonal_ = glm::distance(low_, high_);
  const double disc = static_cast<double>(pi) * diagonal_ * diagonal_ / 4;
  for (const scene::Light& light : scene.lights) {
    Source source{.position = glm::vec3(light.position - origin),
                  .direction = glm::normalize(glm::vec3(light.direction)),
                  .intensity = light.intensity};
    double extent = 4 * pi;
    if (light.kind == scene::LightKind::directional) {
      source.kind = Kind::directional;
      extent = disc;
    } else if (light.kind == scene::LightKind::spot) {
      source.kind = Kind::spot;
      source.cos_outer = static_cast<float>(std::cos(light.outer_rad));
      // KHR_lights_punctual: the bound keeps the falloff finite for a hard edge.
      source.inverse_range =
          static_cast<float>(1 / std::max(.001, std::cos(light.inner_rad) - std::cos(light.outer_rad)));
      extent = 2 * pi * (1 - std::cos(light.outer_rad));
    }
    add(source, extent * mean(light.intensity));
  }
  add({.kind = Kind::sky, .intensity = scene.sky}, 4 * pi * disc * mean(scene.sky));
  for (double& share : cumulative_) share /= cumulative_.back();
}

void PhotonSources::add(const Source& source, double power) {
  if (!(power > 0) || !std::isfinite(power)) return;
  sources_.push_back(source);
  cumulative_.push_back(power + (cumulative_.empty() ? 0 : cumulative_.back()));
}

void PhotonSources::enter(EmittedPhoton& photon, const glm::vec3& direction, glm::vec2 u,
                          const glm::vec3& flux_density) const {
  const float r = .5F * diagonal_ * std::sqrt(u.x);
  const glm::vec3 local(r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), -.51F * diagonal_);
  photon.origin = .5F * (low_ + high_) + turned(local, direction);
  photon.direction = direction;
  photon.flux = flux_density * (pi * diagonal_ * diagonal_ / 4);
}

EmittedPhoton PhotonSources::sample(const PathSampler& sampler) const {
  const glm::vec2 choice = sampler.pair(0), u = sampler.pair(1), v = sampler.pair(2);
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), static_cast<double>(choice.x));
  const auto i = std::min(static_cast<std::size_t>(found - cumulative_.begin()), sources_.size() - 1);
  const Source& source = sources_[i];
  const double probability = cumulative_[i] - (i == 0 ? 0 : cumulative_[i - 1]);
  EmittedPhoton photon;
  photon.punctual = source.kind != Kind::triangle && source.kind != Kind::sky;
  if (source.kind == Kind::directional) {
    enter(photon, source.direction, u, source.intensity);
  } else if (source.kind == Kind::sky) {
    const glm::vec3 direction = on_sphere(u, -1);
    enter(photon, direction, v, sky_.radiance(-direction) * (4 * pi));
  } else if (source.kind == Kind::triangle) {
    const Geometry& g = geometry_.geometries()[source.triangle.geometry];
    TrianglePoint at = source.triangle;
    const float root = std::sqrt(u.x);
    at.uv = {root * (1 - u.y), root * u.y};
    glm::vec3 a, b, c;
    geometry_.corners(at, a, b, c);
    glm::vec3 front = glm::cross(b - a, c - a) * (g.orientation / (2 * source.area));
    const bool both = g.material->double_sided;
    if (both && choice.y < .5F) front = -front;
    photon.origin = geometry_.position(at) + front * EmbreeScene::offset(a, b, c);
    photon.direction = sample_cosine(front, v);
    photon.flux = geometry_.emission(at) * (pi * source.area * (both ? 2 : 1));
  } else {
    const bool spot = source.kind == Kind::spot;
    const float least = spot ? source.cos_outer : -1;
    photon.origin = source.position;
    photon.direction = turned(on_sphere(u, least), spot ? source.direction : glm::vec3(0, 0, 1));
    photon.flux = source.intensity * (2 * pi * (1 - least));
    if (spot) {
      const float cosine = glm::dot(photon.direction, source.direction);
      const float falloff = glm::clamp((cosine - source.cos_outer) * source.inverse_range, 0.F, 1.F);
      photon.flux *= falloff * falloff;
    }
  }
  photon.flux /= static_cast<float>(probability);
  return photon;
}

}  // namespace loom::reference
