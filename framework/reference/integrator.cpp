// The estimators. With E the irradiance at the visible surface x₀ and L its radiance,
//   L = L_e + ρ₀/π·(E_direct + E_emitter + E_bounce),
//   E_direct  = Σ I V cos/r²                              punctual lights: one a path, by unblocked irradiance
//
//   E_emitter = ∫ L_e(x₁) V cos dω                        light samples and cosine samples, power heuristic
//
//   E_bounce  = ∫ ρ₁/π·E(x₁) cos dω = ⟨ρ₁ E(x₁)⟩          cosine samples: density cos/π, so the weight is ρ₁ alone
//
#include "reference/integrator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "reference/camera_hits.h"
#include "reference/weights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
// Sampler sets: one for the pixel (find_visible), three for each vertex.
enum class Set : std::uint32_t { emitter, choice, direction };
std::uint32_t set_of(int vertex, Set set) {
  return 1 + 3 * static_cast<std::uint32_t>(vertex) + static_cast<std::uint32_t>(set);
}

std::size_t at(int lane) { return static_cast<std::size_t>(lane); }

}  // namespace

Integrator::Integrator(const EmbreeScene& geometry, const Lights& lights, const Options& options)
    : geometry_(geometry), lights_(lights), options_(options) {}

void Integrator::trace(const interop::Camera& camera, glm::ivec2 pixel, std::uint32_t first, int count) {
  find_visible(geometry_, lights_, options_.seed, camera, pixel, first, count, rays16_, paths_, samples_, alive_);
  rays_ += static_cast<std::uint64_t>(count);
  for (int vertex = 0; any_alive(); ++vertex) {
    if (lights_.has_punctual()) add_punctual(vertex);
    if (lights_.has_emitters() && options_.strategy != Strategy::bsdf) add_emitters(vertex);
    const bool last = vertex == options_.bounces;
    if (last && !lights_.has_emitters()) break;
    scatter(vertex);
    follow(vertex, last);
  }
  for (int i = 0; i < count; ++i) {
    Sample& s = samples_[at(i)];
    s.radiance += s.albedo / pi * (s.direct + s.emitter + s.bounce);
  }
}

void Integrator::add_punctual(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    shadow_[at(i)] = 0;
    if (alive_[at(i)] == 0) continue;
    const Path& path = paths_[at(i)];
    const LightSample light = lights_.sample_punctual(path.at, path.sampler.pair(set_of(vertex, Set::choice)).x);
    if (!(light.density > 0)) continue;
    pending_[at(i)] = path.weight * light.value;
    put_shadow_ray(i, light);
  }
  occlude();
  for (int i = 0; i < lanes; ++i) {
    if (shadow_[at(i)] == 0 || shadow16_.blocked(i)) continue;
    (vertex == 0 ? samples_[at(i)].direct : samples_[at(i)].bounce) += pending_[at(i)];
  }
}

void Integrator::add_emitters(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    shadow_[at(i)] = 0;
    if (alive_[at(i)] == 0) continue;
    const Path& path = paths_[at(i)];
    const LightSample light = lights_.sample_emitter(path.at, path.sampler.pair(set_of(vertex, Set::emitter)));
    if (!(light.density > 0)) continue;
    const float cosine = glm::dot(path.at.normal, light.direction);
    if (cosine <= 0 || glm::dot(path.at.geometric_normal, light.direction) <= 0) continue;
    const float share = options_.strategy == Strategy::mis ? power_heuristic(light.density, cosine / pi) : 1;
    pending_[at(i)] = path.weight * light.value * (cosine / light.density * share);
    put_shadow_ray(i, light);
  }
  occlude();
  for (int i = 0; i < lanes; ++i) {
    if (shadow_[at(i)] != 0 && !shadow16_.blocked(i)) emitted(i, vertex) += pending_[at(i)];
  }
}

void Integrator::scatter(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    Path& path = paths_[at(i)];
    path.direction = sample_cosine(path.at.normal, path.sampler.pair(set_of(vertex, Set::direction)));
    const float cosine = glm::dot(path.at.normal, path.direction);
    path.density = cosine / pi;
    // Below the triangle's plane the surface is in its own way.
    if (cosine <= 0 || glm::dot(path.at.geometric_normal, path.direction) <= 0) alive_[at(i)] = 0;
  }
}

void Integrator::follow(int vertex, bool last) {
  if (!any_alive()) return;
  intersect();
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    Path& path = paths_[at(i)];
    const SurfacePoint from = path.at;
    const bool sky = !rays16_.hit(i);
    if (!sky) path.at = geometry_.surface(rays16_.point(i), path.direction);
    const glm::vec3 radiance = sky ? lights_.sky(path.direction) : path.at.emission;
    if (options_.strategy != Strategy::light && radiance != glm::vec3(0)) {
      float share = 1;
      if (options_.strategy == Strategy::mis) {
        share = power_heuristic(path.density, sky ? lights_.sky_density(from, path.direction)
                                                  : lights_.density(from.start(), path.at, path.direction));
      }
      emitted(i, vertex) += path.weight * radiance * (pi * share);
    }
    path.weight *= path.at.albedo;
    if (sky || last || !roulette(i, vertex)) alive_[at(i)] = 0;
  }
}

bool Integrator::roulette(int lane, int vertex) {
  Path& path = paths_[at(lane)];
  const float strongest = std::max(path.weight.x, std::max(path.weight.y, path.weight.z));
  if (!(strongest > 0)) return false;
  if (!options_.roulette) return true;
  const float survival = std::min(strongest / least_weight, most_survival);
  if (path.sampler.pair(set_of(vertex, Set::choice)).y >= survival) return false;
  path.weight /= survival;
  return true;
}

glm::vec3& Integrator::emitted(int lane, int vertex) {
  Sample& s = samples_[at(lane)];
  return vertex == 0 ? s.emitter : s.bounce;
}

void Integrator::intersect() {
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    ++rays_;
    rays16_.put(i, paths_[at(i)].at.start(), paths_[at(i)].direction);
  }
  rays16_.trace(geometry_, alive_.data(), false);
}

void Integrator::put_shadow_ray(int lane, const LightSample& light) {
  ++rays_;
  shadow_[at(lane)] = -1;
  shadow16_.put(lane, paths_[at(lane)].at.start(), light.direction, light.distance);
}

void Integrator::occlude() {
  if (std::any_of(shadow_.begin(), shadow_.end(), [](int v) { return v != 0; })) {
    shadow16_.trace(geometry_, shadow_.data());
  }
}

bool Integrator::any_alive() const {
  return std::any_of(alive_.begin(), alive_.end(), [](int v) { return v != 0; });
}

}  // namespace loom::reference
