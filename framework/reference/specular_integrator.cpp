// The estimators. At the visible surface x₀ the diffuse lobe and the specular ones are followed by paths of their own:
//   L = L_e + L_d + L_s,   L_d = ∫ f_d L_i cos dω,   L_s = ∫ f_s L_i |cos| dω,
// the diffuse ones by cosine, so that the same paths tell irradiance, E = ∫ L_i cos dω, whatever the surface reflects
// of it; the specular ones by visible normals. Later surfaces choose among all their lobes. Light samples and sampled
// directions are weighted by the power heuristic (Veach 1995); a direction that is mirrored or refracted no light
// sample finds, and counts fully. Light of a punctual light through glass or by a mirror is found by neither way: such
// caustics are missing (docs/reference.md).
#include "reference/specular_integrator.h"

#include <algorithm>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/camera_hits.h"
#include "reference/weights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

// Sampler sets: one for the pixel, four for each vertex of each of the two kinds of paths.
constexpr std::uint32_t emitter_set = 0, choice_set = 1, direction_set = 2, lobe_set = 3;

std::size_t at(int lane) { return static_cast<std::size_t>(lane); }

}  // namespace

SpecularIntegrator::SpecularIntegrator(const EmbreeScene& geometry, const Lights& lights, const Options& options)
    : geometry_(geometry), lights_(lights), options_(options) {}

std::uint32_t SpecularIntegrator::set_of(int vertex, std::uint32_t which) const {
  return 1 + 8 * static_cast<std::uint32_t>(vertex) + (first_ == Lobes::specular ? 4 : 0) + which;
}

Lobes SpecularIntegrator::lobes_at(int vertex) const { return vertex == 0 ? first_ : Lobes::all; }

void SpecularIntegrator::trace(const interop::Camera& camera, glm::ivec2 pixel, std::uint32_t first, int count) {
  find_visible(geometry_, lights_, options_.seed, camera, pixel, first, count, rays16_, seen_, samples_, hit_);
  rays_ += static_cast<std::uint64_t>(count);
  follow_all(Lobes::diffuse);
  follow_all(Lobes::specular);
}

void SpecularIntegrator::follow_all(Lobes first) {
  first_ = first;
  paths_ = seen_;
  for (int i = 0; i < lanes; ++i) {
    alive_[at(i)] = first == Lobes::diffuse || (hit_[at(i)] != 0 && seen_[at(i)].at.glossy) ? hit_[at(i)] : 0;
  }
  for (int vertex = 0; any_alive(); ++vertex) {
    if (lights_.has_punctual()) add_punctual(vertex);
    if (lights_.has_emitters() && options_.strategy != Strategy::bsdf) add_emitters(vertex);
    const bool last = vertex == options_.bounces;
    if (last && !lights_.has_emitters()) break;
    scatter(vertex);
    follow(vertex, last);
  }
}

void SpecularIntegrator::add(int lane, int vertex, const glm::vec3& at_eye, const glm::vec3& as_irradiance,
                             glm::vec3& layer) {
  Sample& s = samples_[at(lane)];
  s.radiance += at_eye;
  if (first_ == Lobes::specular) {
    s.specular += at_eye;
  } else {
    (vertex == 0 ? layer : s.bounce) += as_irradiance;
  }
}

void SpecularIntegrator::put_shadow_ray(int lane, const LightSample& light) {
  const bool told = first_ == Lobes::diffuse;
  if (pending_[at(lane)] == glm::vec3(0) && (!told || pending_irradiance_[at(lane)] == glm::vec3(0))) return;
  shadow_[at(lane)] = -1;
  ++rays_;
  shadow16_.put(lane, paths_[at(lane)].at.start(), light.direction, light.distance);
}

void SpecularIntegrator::resolve_shadows(int vertex, bool punctual) {
  if (std::none_of(shadow_.begin(), shadow_.end(), [](int v) { return v != 0; })) return;
  shadow16_.trace(geometry_, shadow_.data());
  for (int i = 0; i < lanes; ++i) {
    if (shadow_[at(i)] == 0 || shadow16_.blocked(i)) continue;
    Sample& s = samples_[at(i)];
    add(i, vertex, pending_[at(i)], pending_irradiance_[at(i)], punctual ? s.direct : s.emitter);
  }
}

void SpecularIntegrator::add_punctual(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    shadow_[at(i)] = 0;
    if (alive_[at(i)] == 0) continue;
    const Path& path = paths_[at(i)];
    const LightSample light = lights_.sample_punctual(path.at, path.sampler.pair(set_of(vertex, choice_set)).x);
    if (!(light.density > 0)) continue;
    // `value` is irradiance: the cosine is in it. At x₀ irradiance is what it is; further on the surface reflects it.
    const glm::vec3 f = path.bsdf().evaluate(light.direction, lobes_at(vertex));
    pending_[at(i)] = path.weight * f * light.value;
    pending_irradiance_[at(i)] = path.irradiance * light.value * (vertex == 0 ? glm::vec3(1) : f);
    put_shadow_ray(i, light);
  }
  resolve_shadows(vertex, true);
}

void SpecularIntegrator::add_emitters(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    shadow_[at(i)] = 0;
    if (alive_[at(i)] == 0) continue;
    const Path& path = paths_[at(i)];
    const LightSample light = lights_.sample_emitter(path.at, path.sampler.pair(set_of(vertex, emitter_set)));
    if (!(light.density > 0)) continue;
    const float cosine = glm::dot(path.at.normal, light.direction);
    if (cosine <= 0 || glm::dot(path.at.geometric_normal, light.direction) <= 0) continue;
    const Bsdf bsdf = path.bsdf();
    const Lobes lobes = lobes_at(vertex);
    const float share =
        options_.strategy == Strategy::mis ? power_heuristic(light.density, bsdf.density(light.direction, lobes)) : 1;
    const glm::vec3 arrives = light.value * (cosine / light.density * share);
    const glm::vec3 f = bsdf.evaluate(light.direction, lobes);
    pending_[at(i)] = path.weight * f * arrives;
    pending_irradiance_[at(i)] = path.irradiance * arrives * (vertex == 0 ? glm::vec3(1) : f);
    put_shadow_ray(i, light);
  }
  resolve_shadows(vertex, false);
}

void SpecularIntegrator::scatter(int vertex) {
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    Path& path = paths_[at(i)];
    const Lobes lobes = lobes_at(vertex);
    const glm::vec2 choice(path.sampler.pair(set_of(vertex, lobe_set)));
    const BsdfSample s = path.bsdf().sample(lobes, path.sampler.pair(set_of(vertex, direction_set)), choice);
    path.weight *= s.weight;
    // Irradiance at x₀ is found by cosine: its factor is π, also where the surface reflects nothing.
    path.irradiance *= vertex == 0 ? glm::vec3(pi) : s.weight;
    path.direction = s.direction;
    path.density = s.density;
    const bool dead = s.direction == glm::vec3(0) || (s.density == 0 && s.weight == glm::vec3(0));
    if (dead) alive_[at(i)] = 0;
  }
}

void SpecularIntegrator::follow(int vertex, bool last) {
  if (!any_alive()) return;
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    ++rays_;
    rays16_.put(i, paths_[at(i)].at.start(paths_[at(i)].direction), paths_[at(i)].direction);
  }
  rays16_.trace(geometry_, alive_.data(), false);
  for (int i = 0; i < lanes; ++i) {
    if (alive_[at(i)] == 0) continue;
    Path& path = paths_[at(i)];
    const SurfacePoint from = path.at;
    const bool sky = !rays16_.hit(i);
    if (!sky) path.at = geometry_.surface(rays16_.point(i), path.direction);
    const glm::vec3 radiance = sky ? lights_.sky(path.direction) : path.at.emission;
    const bool findable = path.density > 0;
    if (radiance != glm::vec3(0) && (options_.strategy != Strategy::light || !findable)) {
      float share = 1;
      if (options_.strategy == Strategy::mis && findable) {
        share = power_heuristic(path.density, sky ? lights_.sky_density(from, path.direction)
                                                  : lights_.density(from.start(), path.at, path.direction));
      }
      add(i, vertex, path.weight * radiance * share, path.irradiance * radiance * share, samples_[at(i)].emitter);
    }
    if (sky || last || !roulette(i, vertex)) alive_[at(i)] = 0;
  }
}

bool SpecularIntegrator::roulette(int lane, int vertex) {
  Path& path = paths_[at(lane)];
  const bool told = first_ == Lobes::diffuse;  // irradiance is asked for
  const float strongest = std::max(largest(path.weight), told ? largest(path.irradiance) / pi : 0);
  if (!(strongest > 0)) return false;
  if (!options_.roulette) return true;
  const float survival = std::min(strongest / least_weight, most_survival);
  if (path.sampler.pair(set_of(vertex, choice_set)).y >= survival) return false;
  path.weight /= survival;
  path.irradiance /= survival;
  return true;
}

bool SpecularIntegrator::any_alive() const {
  return std::any_of(alive_.begin(), alive_.end(), [](int v) { return v != 0; });
}

}  // namespace loom::reference
