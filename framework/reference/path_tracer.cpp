#include "reference/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include <tbb/blocked_range2d.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "loom/diagnostic.h"
#include "reference/embree_scene.h"
#include "reference/integrator.h"
#include "reference/lights.h"
#include "reference/sampler.h"
#include "reference/specular_integrator.h"
#include "scene/gpu_scene.h"

namespace loom::reference {
namespace {

class Hash {
 public:
  void add(std::uint64_t v) { value_ = mix_bits(value_ ^ (v + 0x9e3779b97f4a7c15U)); }
  void add(double v) { add(std::bit_cast<std::uint64_t>(v)); }
  void add(const glm::dvec3& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 1;
};

}  // namespace

FilmIdentity identify(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size, const Options& options) {
  Hash hash;
  hash.add(scene.content_hash);
  hash.add(camera.eye);
  hash.add(camera.target);
  hash.add(camera.up);
  hash.add(static_cast<std::uint64_t>(camera.orthographic));
  hash.add(camera.orthographic ? camera.ymag : camera.yfov_rad);
  hash.add(camera.orthographic ? camera.xmag : 0.);
  hash.add(static_cast<std::uint64_t>(size.x));
  hash.add(static_cast<std::uint64_t>(size.y));
  return {hash.value(), options.bounces};
}

interop::Camera view_of(const scene::Camera& camera, const scene::Scene& scene, glm::ivec2 size,
                        const glm::dvec3& origin) {
  scene::Camera relative = camera;
  relative.eye -= origin;
  relative.target -= origin;
  return scene::make_camera(relative, scene, size);
}

interop::Camera relative_to(const glm::dvec3& origin, interop::Camera camera) {
  const glm::vec3 eye(glm::dvec3(camera.eye) - origin);
  camera.eye = glm::vec4(eye, camera.eye.w);
  return camera;
}

struct PathTracer::State {
  State(const scene::Scene& scene, const glm::dvec3& origin, Options given)
      : options(given),
        geometry(scene, origin),
        lights(scene, geometry, origin),
        glossy(geometry.any_glossy()),
        arena(given.threads > 0 ? std::min(given.threads, tbb::info::default_concurrency())
                                : tbb::task_arena::automatic) {}

  Options options;
  EmbreeScene geometry;
  Lights lights;
  bool glossy;
  tbb::task_arena arena;
};

PathTracer::PathTracer(const scene::Scene& scene, const glm::dvec3& origin, Options options) {
  if (!options.roulette && options.bounces < 0) throw Error("without roulette a limit of bounces is needed");
  state_ = std::make_unique<State>(scene, origin, options);
}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

const Options& PathTracer::options() const { return state_->options; }

void PathTracer::accumulate(Film& film, const interop::Camera& camera, std::uint32_t samples, int first_row,
                            int last_row) const {
  std::atomic<std::uint64_t> rays = 0;
  const tbb::blocked_range2d<int> pixels(first_row, std::min(last_row, film.size().y), 4, 0, film.size().x, 16);
  state_->arena.execute([&] {
    const auto trace = [&](const tbb::blocked_range2d<int>& tile, auto&& integrator) {
      for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
        for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
          PixelSums& sums = film.pixel(x, y);
          while (sums.count < samples) {
            const auto count = static_cast<int>(std::min<std::uint32_t>(samples - sums.count, lanes));
            integrator.trace(camera, {x, y}, sums.count, count);
            for (int i = 0; i < count; ++i) Film::add(sums, integrator.samples()[static_cast<std::size_t>(i)]);
          }
        }
      }
      rays += integrator.rays();
    };
    // Where all surfaces are diffuse, the specialised integrator is faster.
    tbb::parallel_for(pixels, [&](const tbb::blocked_range2d<int>& tile) {
      const State& s = *state_;
      if (s.glossy) {
        trace(tile, SpecularIntegrator(s.geometry, s.lights, s.options));
      } else {
        trace(tile, Integrator(s.geometry, s.lights, s.options));
      }
    });
  });
  film.rays += rays;
}

}  // namespace loom::reference
