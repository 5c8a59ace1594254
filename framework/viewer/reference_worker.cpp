#include "viewer/reference_worker.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "loom/diagnostic.h"
#include "reference/film.h"
#include "reference/path_tracer.h"

namespace loom::viewer {
namespace {

constexpr std::uint32_t round = 16;     // samples a pixel between two looks; film.h has as many replicates
constexpr int rows_between_stops = 16;  // rows traced before it is asked whether to stop

/// Three planes that a measure::Layer views.
template <class Pixel>
std::array<std::vector<float>, 3> planes_of(const std::vector<Pixel>& pixels) {
  std::array<std::vector<float>, 3> planes;
  for (int c = 0; c < 3; ++c)
    for (const Pixel& pixel : pixels) planes[static_cast<std::size_t>(c)].push_back(pixel[c]);
  return planes;
}

measure::Layer layer_of(const std::array<std::vector<float>, 3>& planes, glm::ivec2 size) {
  return {.width = size.x,
          .height = size.y,
          .name = "RGB",
          .channels = {"R", "G", "B"},
          .planes = {planes[0], planes[1], planes[2]}};
}

}  // namespace

void ReferenceWorker::start(scene::Scene scene, const scene::Camera& camera, glm::ivec2 size) {
  stop();
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t version = state_.version + 1;
    state_ = {};
    state_.version = version;
    state_.size = size;
    picture_.clear();
    picture_id_ = 0;
  }
  stop_ = false;
  thread_ = std::thread([this, scene = std::move(scene), camera, size] { work(scene, camera, size); });
}

void ReferenceWorker::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ReferenceWorker::measure(std::uint64_t picture, std::vector<glm::vec4> radiance) {
  {
    const std::lock_guard lock(mutex_);
    picture_ = std::move(radiance);
    picture_id_ = picture;
  }
  wake_.notify_all();
}

std::optional<ReferenceState> ReferenceWorker::newer_than(std::uint64_t version) const {
  const std::lock_guard lock(mutex_);
  return state_.version > version ? std::optional(state_) : std::nullopt;
}

void ReferenceWorker::work(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size) {
  try {
    // One core is left to the window and its pipeline.
    const int threads = std::max(static_cast<int>(std::thread::hardware_concurrency()) - 1, 1);
    const reference::PathTracer tracer(scene, camera.eye, {.threads = threads});
    const interop::Camera rays = reference::view_of(camera, scene, size, camera.eye);
    reference::Film film(size, {}, 0);
    for (std::uint32_t samples = round; samples <= enough; samples += round) {
      for (int row = 0; row < size.y; row += rows_between_stops) {
        if (stop_) return;
        tracer.accumulate(film, rays, samples, row, std::min(row + rows_between_stops, size.y));
      }
      std::vector<glm::vec3> radiance;
      radiance.reserve(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) radiance.emplace_back(reference::Film::mean(film.pixel(x, y)));
      {
        const std::lock_guard lock(mutex_);
        state_.radiance = std::move(radiance);
        state_.samples = samples;
        state_.noise = film.relative_error();
        state_.done = samples + round > enough;
        ++state_.version;
      }
      compare();
    }
    // The truth is there; pictures may still change.
    while (!stop_) {
      std::uint64_t measured = 0;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stop_ || picture_id_ != state_.picture; });
        measured = picture_id_;
      }
      if (stop_) return;
      compare();
      const std::lock_guard lock(mutex_);
      state_.picture = measured;  // also where it could not be compared: it is not asked for again
    }
  } catch (const Error&) {
    const std::lock_guard lock(mutex_);
    state_.done = true;
    ++state_.version;
  }
}

void ReferenceWorker::compare() {
  std::vector<glm::vec4> picture;
  std::vector<glm::vec3> truth;
  std::uint64_t id = 0;
  glm::ivec2 size{0};
  {
    const std::lock_guard lock(mutex_);
    picture = picture_;
    truth = state_.radiance;
    id = picture_id_;
    size = state_.size;
  }
  if (picture.size() != truth.size() || picture.empty()) return;
  const auto a = planes_of(picture), b = planes_of(truth);
  measure::Comparison comparison = measure::compare(layer_of(a, size), layer_of(b, size), true);
  const std::lock_guard lock(mutex_);
  state_.metrics = comparison.metrics;
  state_.flip = comparison.flip ? std::move(comparison.flip->error) : std::vector<float>();
  state_.picture = id;
  ++state_.version;
}

}  // namespace loom::viewer
