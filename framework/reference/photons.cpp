// A photon is a share of a source's flux, Φ = Φ_source/(N·p). Where it meets a surface it is stored, with the direction
// that it came from; then the surface reflects it: by roulette with probability max ρ, by density cosθ/π about the
// geometric normal, with Φ·ρ/max ρ·c, c = ⟨n,ω⟩₊/⟨n_g,ω⟩ for the shading normal n (what the BRDF ρ/π makes of an
// irradiance that is weighted with n). Irradiance at a pixel's surface point x is E = Σ Φ·c/(πr²) over the photons
// within r of x, on the same side of nearly the same plane. Its bias: E is the mean over the disc (of order r² where E
// is smooth), and the disc reaches over edges, where up to half of it is empty (of order r).
// Where surfaces are more than diffuse, a photon is sent on by the lobe that it falls to, and the pixel's radiance is
//   L = L_e + Σ f_d·Φ·c/(πr²) + L_s,
// L_s by a path from the eye through specular lobes: at every surface that it meets it adds L_e and what the diffuse
// lobe makes of photons. That leaves out one kind of path, from a punctual light to the eye by specular lobes alone,
// which no sampled direction finds. Photons that have come so ("caustic") count for the specular lobe, too, at the
// first surface where they can: the first whose lobe is rough.
#include "reference/photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "reference/bsdf.h"
#include "reference/camera_hits.h"
#include "reference/embree_scene.h"
#include "reference/lights.h"
#include "reference/packet.h"
#include "reference/path_tracer.h"
#include "reference/photon_map.h"
#include "reference/photon_sources.h"
#include "reference/sampler.h"
#include "reference/weights.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
/// α of the shrinking radius: what both errors fall with fastest, noise as i^(−α/2) (Knaus and Zwicker, section 4).
constexpr double shrink = 2. / 3;
constexpr int chunk = 4096;                               ///< photons of one task
constexpr std::uint64_t photon_stream = 0x70686f746f6eU;  ///< apart from the path tracer's numbers

std::size_t at(int i) { return static_cast<std::size_t>(i); }

glm::vec3& layer(Kind kind, Sample& sample) {
  return kind == Kind::direct ? sample.direct : kind == Kind::emitter ? sample.emitter : sample.bounce;
}

/// From the eye through specular lobes. Samples begin at 1: one for the pixel, three for each surface.
struct EyePath {
  PathSampler sampler;
  SurfacePoint at;
  glm::vec3 direction{0};  ///< of the ray that led to `at`
  glm::vec3 weight{1};
  /// Whether a rough lobe was met that has told of all caustic photons on this way.
  bool caustics_found = false;
};

}  // namespace

FilmIdentity identify(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size,
                      const PhotonOptions& options) {
  FilmIdentity identity = identify(scene, camera, size, Options{.bounces = options.bounces});
  identity.scene = mix_bits(identity.scene ^ photon_stream ^ static_cast<std::uint64_t>(options.photons) ^
                            mix_bits(static_cast<std::uint64_t>(options.radius * 1e9)));
  return identity;
}

struct PhotonMapper::State {
  State(const scene::Scene& scene, const glm::dvec3& origin, const PhotonOptions& given)
      : options(given),
        geometry(scene, origin),
        lights(scene, geometry, origin),
        sources(scene, geometry, origin),
        sets_of_order(geometry.any_glossy() ? 3 : 2),
        arena(given.threads > 0 ? std::min(given.threads, tbb::info::default_concurrency())
                                : tbb::task_arena::automatic) {}

  /// Photons [first, first + count) of a pass; returns the rays that it took.
  std::uint64_t send(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const;
  std::uint64_t send_packet(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const;
  /// The photon's next leg from x; false where it ends. `set`: the sampler's next.
  static bool scatter_diffusely(const SurfacePoint& x, const PathSampler& sampler, std::uint32_t set,
                                EmittedPhoton& photon);
  static bool scatter(const SurfacePoint& x, const PathSampler& sampler, std::uint32_t set, EmittedPhoton& photon,
                      bool& caustic);
  /// Samples of a row; returns the rays that they took.
  std::uint64_t gather_row(Film& film, const interop::Camera& camera, std::uint32_t pass, int row,
                           const PhotonMap& map) const;
  /// What the photons at `path` become at the viewer, as radiance: by the diffuse lobe, and by the specular ones.
  /// `vertex`: surfaces on the way. Adds to the irradiance of the first one.
  void reflect(const PhotonMap& map, const EyePath& path, int vertex, Sample& sample, glm::vec3& diffuse,
               glm::vec3& specular) const;
  /// Sends the paths on through specular lobes until they end, and adds what they find to the samples.
  std::uint64_t follow(const PhotonMap& map, std::array<EyePath, lanes>& paths, int* alive,
                       std::array<Sample, lanes>& samples) const;

  PhotonOptions options;
  EmbreeScene geometry;
  Lights lights;
  PhotonSources sources;
  std::uint32_t sets_of_order;  ///< sampler sets that a photon takes at a surface
  mutable tbb::task_arena arena;
};

bool PhotonMapper::State::scatter_diffusely(const SurfacePoint& x, const PathSampler& sampler, std::uint32_t set,
                                            EmittedPhoton& photon) {
  const float survival = std::min(most_survival, largest(x.albedo));
  if (sampler.pair(set).x >= survival) return false;
  photon.flux *= x.albedo * (shading_ratio(x.normal, x.geometric_normal, photon.direction) / survival);
  photon.origin = x.start();
  photon.direction = sample_cosine(x.geometric_normal, sampler.pair(set + 1));
  return true;
}

bool PhotonMapper::State::scatter(const SurfacePoint& x, const PathSampler& sampler, std::uint32_t set,
                                  EmittedPhoton& photon, bool& caustic) {
  const FluxSample s = Bsdf(x, -photon.direction).sample_flux(sampler.pair(set + 1), sampler.pair(set + 2));
  const float survival = std::min(most_survival, largest(s.weight));
  if (sampler.pair(set).x >= survival) return false;
  photon.flux *= s.weight / survival;
  photon.origin = x.start(s.direction);
  photon.direction = s.direction;
  caustic = caustic && s.specular;
  return true;
}

std::uint64_t PhotonMapper::State::send_packet(std::uint32_t pass, int first, int count,
                                               std::vector<Photon>& stored) const {
  struct Path {
    PathSampler sampler;
    EmittedPhoton photon;
    bool caustic = false;
  };
  std::array<Path, lanes> paths;
  alignas(64) std::array<int, lanes> alive{};
  Packet packet;
  std::uint64_t rays = 0;
  for (int i = 0; i < count; ++i) {
    Path& path = paths[at(i)];
    path.sampler = PathSampler(options.seed ^ photon_stream, pass, 0, static_cast<std::uint32_t>(first + i));
    path.photon = sources.sample(path.sampler);
    path.photon.flux /= static_cast<float>(options.photons);
    path.caustic = path.photon.punctual;
    alive[at(i)] = -1;
  }
  for (int order = 0; options.bounces < 0 || order <= options.bounces; ++order) {
    if (std::none_of(alive.begin(), alive.end(), [](int lane) { return lane != 0; })) break;
    for (int i = 0; i < count; ++i) {
      if (alive[at(i)] == 0) continue;
      ++rays;
      packet.put(i, paths[at(i)].photon.origin, paths[at(i)].photon.direction);
    }
    packet.trace(geometry, alive.data(), false);
    for (int i = 0; i < count; ++i) {
      if (alive[at(i)] == 0) continue;
      EmittedPhoton& photon = paths[at(i)].photon;
      if (!packet.hit(i)) {
        alive[at(i)] = 0;
        continue;
      }
      const SurfacePoint x = geometry.surface(packet.point(i), photon.direction);
      const Kind kind = order > 0 ? Kind::bounce : photon.punctual ? Kind::direct : Kind::emitter;
      bool& caustic = paths[at(i)].caustic;
      stored.push_back({x.position, photon.direction, x.geometric_normal, photon.flux, order, kind, caustic});
      const std::uint32_t set = PhotonSources::sets + sets_of_order * static_cast<std::uint32_t>(order);
      const bool on = x.glossy ? scatter(x, paths[at(i)].sampler, set, photon, caustic)
                               : scatter_diffusely(x, paths[at(i)].sampler, set, photon);
      if (!x.glossy) caustic = false;
      if (!on) alive[at(i)] = 0;
    }
  }
  return rays;
}

std::uint64_t PhotonMapper::State::send(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const {
  std::uint64_t rays = 0;
  for (int i = 0; i < count; i += lanes) rays += send_packet(pass, first + i, std::min(lanes, count - i), stored);
  return rays;
}

void PhotonMapper::State::reflect(const PhotonMap& map, const EyePath& path, int vertex, Sample& sample,
                                  glm::vec3& diffuse, glm::vec3& specular) const {
  const SurfacePoint& x = path.at;
  const bool caustics = x.glossy && !path.caustics_found;
  if (vertex > 0 && !caustics && x.albedo == glm::vec3(0)) return;
  const Bsdf bsdf(x, -path.direction);
  map.visit(x, [&](const Photon& photon, float density) {
    if (options.bounces >= 0 && vertex + photon.order > options.bounces) return;
    const glm::vec3 e = photon.flux * density;
    if (vertex == 0) layer(photon.kind, sample) += e;
    diffuse += bsdf.evaluate(-photon.direction, Lobes::diffuse) * e;
    if (caustics && photon.caustic) specular += bsdf.evaluate(-photon.direction, Lobes::specular) * e;
  });
}

std::uint64_t PhotonMapper::State::follow(const PhotonMap& map, std::array<EyePath, lanes>& paths, int* alive,
                                          std::array<Sample, lanes>& samples) const {
  const auto any = [&] { return std::any_of(alive, alive + lanes, [](int lane) { return lane != 0; }); };
  Packet packet;
  std::uint64_t rays = 0;
  for (int vertex = 0; any(); ++vertex) {
    const std::uint32_t set = 1 + 3 * static_cast<std::uint32_t>(vertex);
    for (int i = 0; i < lanes; ++i) {
      if (alive[i] == 0) continue;
      EyePath& path = paths[at(i)];
      const BsdfSample s =
          Bsdf(path.at, -path.direction).sample(Lobes::specular, path.sampler.pair(set), path.sampler.pair(set + 1));
      path.weight *= s.weight;
      path.direction = s.direction;
      // A direction without a density is one that evaluate() leaves out: mirrored or refracted.
      path.caustics_found = path.caustics_found || s.density > 0;
      if (path.weight == glm::vec3(0)) {
        alive[i] = 0;
        continue;
      }
      ++rays;
      packet.put(i, path.at.start(s.direction), s.direction);
    }
    packet.trace(geometry, alive, false);
    for (int i = 0; i < lanes; ++i) {
      if (alive[i] == 0) continue;
      EyePath& path = paths[at(i)];
      Sample& sample = samples[at(i)];
      if (!packet.hit(i)) {
        sample.specular += path.weight * lights.sky(path.direction);
        alive[i] = 0;
        continue;
      }
      path.at = geometry.surface(packet.point(i), path.direction);
      sample.specular += path.weight * path.at.emission;
      if (vertex == options.bounces) {
        alive[i] = 0;
        continue;
      }
      glm::vec3 reflected(0);
      reflect(map, path, vertex + 1, sample, reflected, reflected);
      sample.specular += path.weight * reflected;
      const float survival = std::min(most_survival, largest(path.weight) / least_weight);
      if (!path.at.glossy || path.sampler.pair(set + 2).x >= survival) alive[i] = 0;
      path.weight /= survival;
    }
  }
  return rays;
}

std::uint64_t PhotonMapper::State::gather_row(Film& film, const interop::Camera& camera, std::uint32_t pass, int row,
                                              const PhotonMap& map) const {
  alignas(64) std::array<int, lanes> valid{};
  Packet packet;
  std::uint64_t rays = 0;
  for (int left = 0; left < film.size().x; left += lanes) {
    const int count = std::min(lanes, film.size().x - left);
    std::array<EyePath, lanes> paths;
    std::array<Sample, lanes> samples;
    for (int i = 0; i < lanes; ++i) {
      valid[at(i)] = i < count ? -1 : 0;
      if (i >= count) continue;
      const int column = left + i;
      const auto number = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(film.size().x) +
                          static_cast<std::uint64_t>(column);
      EyePath& path = paths[at(i)];
      path.sampler = PathSampler(options.seed ^ mix_bits(photon_stream), number, pass % replicates, pass / replicates);
      glm::vec3 eye(0);
      path.direction = camera_ray(camera, {column, row}, path.sampler.pair(0), eye);
      packet.put(i, eye, path.direction);
    }
    rays += static_cast<std::uint64_t>(count);
    packet.trace(geometry, valid.data(), true);
    for (int i = 0; i < count; ++i) {
      Sample& sample = samples[at(i)];
      EyePath& path = paths[at(i)];
      sample.radiance = lights.sky(path.direction);
      valid[at(i)] = 0;
      if (!packet.hit(i)) continue;
      path.at = geometry.surface(packet.point(i), path.direction);
      const SurfacePoint& x = path.at;
      sample.hit = true;
      sample.depth = packet.distance(i);
      sample.albedo = x.albedo;
      sample.normal = x.normal;
      glm::vec3 diffuse(0);
      reflect(map, path, 0, sample, diffuse, sample.specular);
      if (!x.glossy) diffuse = x.albedo / pi * (sample.direct + sample.emitter + sample.bounce);
      sample.radiance = x.emission + diffuse;
      if (x.glossy) valid[at(i)] = -1;
    }
    rays += follow(map, paths, valid.data(), samples);
    for (int i = 0; i < count; ++i) {
      samples[at(i)].radiance += samples[at(i)].specular;
      Film::add(film.pixel(left + i, row), samples[at(i)]);
    }
  }
  return rays;
}

PhotonMapper::PhotonMapper(const scene::Scene& scene, const glm::dvec3& origin, const PhotonOptions& options)
    : state_(std::make_unique<State>(scene, origin, options)) {}
PhotonMapper::~PhotonMapper() = default;
PhotonMapper::PhotonMapper(PhotonMapper&&) noexcept = default;
PhotonMapper& PhotonMapper::operator=(PhotonMapper&&) noexcept = default;

double PhotonMapper::radius(std::uint32_t pass) const {
  double square = std::pow(state_->options.radius * state_->sources.diagonal(), 2);
  for (std::uint32_t i = 1; i <= pass; ++i) square *= (i + shrink) / (i + 1.);
  return std::sqrt(square);
}

void PhotonMapper::accumulate(Film& film, const interop::Camera& camera) const {
  const State& s = *state_;
  const std::uint32_t pass = film.least_count();
  const int chunks = s.sources.dark() ? 0 : (s.options.photons + chunk - 1) / chunk;
  // Kept by task, so that the order of photons, and with it every sum, does not depend on the threads.
  std::vector<std::vector<Photon>> stored(at(chunks));
  std::vector<std::uint64_t> rays(at(chunks)), eye_rays(at(film.size().y));
  s.arena.execute([&] {
    tbb::parallel_for(0, chunks, [&](int c) {
      const int first = c * chunk;
      rays[at(c)] = s.send(pass, first, std::min(chunk, s.options.photons - first), stored[at(c)]);
    });
    const PhotonMap map(stored, s.sources.low(), s.sources.high(), static_cast<float>(radius(pass)));
    tbb::parallel_for(0, film.size().y,
                      [&](int row) { eye_rays[at(row)] = s.gather_row(film, camera, pass, row, map); });
  });
  for (const std::uint64_t count : rays) film.rays += count;
  for (const std::uint64_t count : eye_rays) film.rays += count;
}

}  // namespace loom::reference
