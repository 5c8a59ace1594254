// A photon is a share of a source's flux, Φ = Φ_source/(N·p). Where it meets a surface it is stored, with the direction
// that it came from; then the surface reflects it: by roulette with probability max ρ, by density cosθ/π about the
// geometric normal, with Φ·ρ/max ρ·c, c = ⟨n,ω⟩₊/⟨n_g,ω⟩ for the shading normal n (what the BRDF ρ/π makes of an
// irradiance that is weighted with n). Irradiance at a pixel's surface point x is E = Σ Φ·c/(πr²) over the photons
// within r of x, on the same side of nearly the same plane. Its bias: E is the mean over the disc (of order r² where E
// is smooth), and the disc reaches over edges, where up to half of it is empty (of order r).
#include "reference/photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "loom/diagnostic.h"
#include "reference/embree_scene.h"
#include "reference/lights.h"
#include "reference/packet.h"
#include "reference/path_tracer.h"
#include "reference/photon_sources.h"
#include "reference/sampler.h"

namespace loom::reference {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
/// α of the shrinking radius: what both errors fall with fastest, noise as i^(−α/2) (Knaus and Zwicker, section 4).
constexpr double shrink = 2. / 3;
/// Photons on a plane turned by more than this cosine are another surface's, as are those this share of r off the
/// plane.
constexpr float same_normal = .9F, same_plane = .25F;
constexpr float most_survival = 1 - 0x1p-10F;
constexpr int chunk = 4096;                               ///< photons of one task
constexpr int most_cells = 128;                           ///< of the search grid along an axis
constexpr std::uint64_t photon_stream = 0x70686f746f6eU;  ///< apart from the path tracer's numbers

enum class Kind : std::uint8_t { direct, emitter, bounce };

struct Photon {
  glm::vec3 position, direction, normal;
  glm::vec3 flux;
  Kind kind;
};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// ⟨n,ω⟩₊/⟨n_g,ω⟩ for light that travels along `direction`.
float shading_ratio(const glm::vec3& normal, const glm::vec3& geometric, const glm::vec3& direction) {
  return std::max(0.F, -glm::dot(normal, direction)) / std::max(1e-3F, -glm::dot(geometric, direction));
}

/// Photons sorted into cells no smaller than the disc, so that eight hold all that a disc may reach.
class PhotonMap {
 public:
  PhotonMap(const std::vector<std::vector<Photon>>& parts, const glm::vec3& low, const glm::vec3& high, float radius)
      : low_(low), radius_(radius) {
    const glm::vec3 extent = high - low;
    const float longest = std::max(extent.x, std::max(extent.y, extent.z));
    size_ = std::max({2 * radius, longest / most_cells, std::numeric_limits<float>::min()});
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<int>(extent[axis] / size_) + 1;
    first_.assign(at(cells_.x) * at(cells_.y) * at(cells_.z) + 1, 0);
    for (const auto& part : parts) {
      for (const Photon& photon : part) ++first_[cell_of(photon.position) + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    photons_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const auto& part : parts) {
      for (const Photon& photon : part) photons_[next[cell_of(photon.position)]++] = photon;
    }
  }

  void add_irradiance(const SurfacePoint& x, Sample& sample) const {
    const float scale = 1 / (pi * radius_ * radius_);
    const glm::ivec3 first = cell(x.position - radius_), last = cell(x.position + radius_);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int i = first.x; i <= last.x; ++i) {
          const std::size_t c = index({i, y, z});
          for (std::size_t k = first_[c]; k < first_[c + 1]; ++k) add(x, photons_[k], scale, sample);
        }
      }
    }
  }

 private:
  void add(const SurfacePoint& x, const Photon& photon, float scale, Sample& sample) const {
    const glm::vec3 d = photon.position - x.position;
    if (glm::dot(d, d) > radius_ * radius_) return;
    if (glm::dot(photon.normal, x.geometric_normal) < same_normal) return;
    if (std::abs(glm::dot(d, x.geometric_normal)) > same_plane * radius_ + x.offset) return;
    const float ratio = shading_ratio(x.normal, photon.normal, photon.direction);
    const glm::vec3 e = photon.flux * (ratio * scale);
    (photon.kind == Kind::direct ? sample.direct : photon.kind == Kind::emitter ? sample.emitter : sample.bounce) += e;
  }
  [[nodiscard]] glm::ivec3 cell(const glm::vec3& p) const {
    const glm::vec3 w = (p - low_) / size_;
    return glm::clamp(glm::ivec3(glm::floor(w)), glm::ivec3(0), cells_ - 1);
  }
  [[nodiscard]] std::size_t index(const glm::ivec3& c) const {
    return at(c.x) + at(cells_.x) * (at(c.y) + at(cells_.y) * at(c.z));
  }
  [[nodiscard]] std::size_t cell_of(const glm::vec3& p) const { return index(cell(p)); }

  glm::vec3 low_;
  float radius_, size_ = 0;
  glm::ivec3 cells_{1};
  std::vector<std::size_t> first_;
  std::vector<Photon> photons_;
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
        arena(given.threads > 0 ? std::min(given.threads, tbb::info::default_concurrency())
                                : tbb::task_arena::automatic) {}

  /// Photons [first, first + count) of a pass; returns the rays that it took.
  std::uint64_t send(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const;
  std::uint64_t send_packet(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const;
  void gather_row(Film& film, const interop::Camera& camera, std::uint32_t pass, int row, const PhotonMap& map) const;

  PhotonOptions options;
  EmbreeScene geometry;
  Lights lights;
  PhotonSources sources;
  mutable tbb::task_arena arena;
};

std::uint64_t PhotonMapper::State::send_packet(std::uint32_t pass, int first, int count,
                                               std::vector<Photon>& stored) const {
  struct Path {
    PathSampler sampler;
    EmittedPhoton photon;
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
      stored.push_back({x.position, photon.direction, x.geometric_normal, photon.flux, kind});
      const float survival = std::min(most_survival, std::max(x.albedo.x, std::max(x.albedo.y, x.albedo.z)));
      const std::uint32_t set = PhotonSources::sets + 2 * static_cast<std::uint32_t>(order);
      if (paths[at(i)].sampler.pair(set).x >= survival) {
        alive[at(i)] = 0;
        continue;
      }
      photon.flux *= x.albedo * (shading_ratio(x.normal, x.geometric_normal, photon.direction) / survival);
      photon.origin = x.start();
      photon.direction = sample_cosine(x.geometric_normal, paths[at(i)].sampler.pair(set + 1));
    }
  }
  return rays;
}

std::uint64_t PhotonMapper::State::send(std::uint32_t pass, int first, int count, std::vector<Photon>& stored) const {
  std::uint64_t rays = 0;
  for (int i = 0; i < count; i += lanes) rays += send_packet(pass, first + i, std::min(lanes, count - i), stored);
  return rays;
}

void PhotonMapper::State::gather_row(Film& film, const interop::Camera& camera, std::uint32_t pass, int row,
                                     const PhotonMap& map) const {
  const bool orthographic = camera.eye.w != 0;
  alignas(64) std::array<int, lanes> valid{};
  std::array<glm::vec3, lanes> directions;
  Packet packet;
  for (int left = 0; left < film.size().x; left += lanes) {
    const int count = std::min(lanes, film.size().x - left);
    for (int i = 0; i < lanes; ++i) {
      valid[at(i)] = i < count ? -1 : 0;
      if (i >= count) continue;
      const int column = left + i;
      const auto number = static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(film.size().x) +
                          static_cast<std::uint64_t>(column);
      const PathSampler sampler(options.seed ^ mix_bits(photon_stream), number, pass % replicates, pass / replicates);
      const glm::vec2 inside = sampler.pair(0);
      const float a = 2 * (static_cast<float>(column) + inside.x) / camera.size.x - 1;
      const float b = 1 - 2 * (static_cast<float>(row) + inside.y) / camera.size.y;
      const glm::vec3 plane = glm::vec3(camera.right) * a + glm::vec3(camera.up) * b;
      directions[at(i)] = glm::normalize(glm::vec3(camera.forward) + (orthographic ? glm::vec3(0) : plane));
      packet.put(i, glm::vec3(camera.eye) + (orthographic ? plane : glm::vec3(0)), directions[at(i)]);
    }
    packet.trace(geometry, valid.data(), true);
    for (int i = 0; i < count; ++i) {
      Sample sample;
      sample.radiance = lights.sky();
      if (packet.hit(i)) {
        const SurfacePoint x = geometry.surface(packet.point(i), directions[at(i)]);
        sample.hit = true;
        sample.depth = packet.distance(i);
        sample.albedo = x.albedo;
        sample.normal = x.normal;
        map.add_irradiance(x, sample);
        sample.radiance = x.emission + x.albedo / pi * (sample.direct + sample.emitter + sample.bounce);
      }
      Film::add(film.pixel(left + i, row), sample);
    }
  }
}

PhotonMapper::PhotonMapper(const scene::Scene& scene, const glm::dvec3& origin, const PhotonOptions& options)
    : state_(std::make_unique<State>(scene, origin, options)) {
  if (!state_->geometry.any_glossy()) return;
  Diagnostic diagnostic;
  diagnostic.code = "photons-diffuse";
  diagnostic.message = "photon mapping follows diffuse light alone, and surfaces here are ggx";
  diagnostic.where.file = scene.path;
  diagnostic.hint = "leave --method photons out, or give --surfaces lambert";
  throw BadInput(diagnostic);
}
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
  std::vector<std::uint64_t> rays(at(chunks));
  s.arena.execute([&] {
    tbb::parallel_for(0, chunks, [&](int c) {
      const int first = c * chunk;
      rays[at(c)] = s.send(pass, first, std::min(chunk, s.options.photons - first), stored[at(c)]);
    });
    const PhotonMap map(stored, s.sources.low(), s.sources.high(), static_cast<float>(radius(pass)));
    tbb::parallel_for(0, film.size().y, [&](int row) { s.gather_row(film, camera, pass, row, map); });
  });
  for (const std::uint64_t count : rays) film.rays += count;
  film.rays += static_cast<std::uint64_t>(film.size().x) * static_cast<std::uint64_t>(film.size().y);
}

}  // namespace loom::reference
