#pragma once
// The path tracer in the background: the truth of one view, and how far the picture is from it.
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "measure/metrics.h"
#include "scene/scene.h"

namespace loom::viewer {

/// What was found so far. Rows from the top.
struct ReferenceState {
  std::uint64_t version = 0;  ///< counts what is new
  glm::ivec2 size{0};
  std::uint32_t samples = 0;  ///< a pixel
  double noise = 0;           ///< relative error that the spread of the samples predicts
  bool done = false;
  std::vector<glm::vec3> radiance;
  std::optional<measure::Metrics> metrics;  ///< of the newest picture
  std::vector<float> flip;                  ///< its FLIP map
  std::uint64_t picture = 0;                ///< which picture that was
};

class ReferenceWorker {
 public:
  /// Samples a pixel after which it rests.
  static constexpr std::uint32_t enough = 1024;

  ReferenceWorker() = default;
  ~ReferenceWorker() { stop(); }
  ReferenceWorker(const ReferenceWorker&) = delete;
  ReferenceWorker& operator=(const ReferenceWorker&) = delete;

  /// Drops what was traced, and begins with this view. The scene is a copy of its own.
  void start(scene::Scene scene, const scene::Camera& camera, glm::ivec2 size);
  void stop();
  [[nodiscard]] bool running() const { return thread_.joinable(); }
  /// Radiance of the picture to measure, rows from the top; of another size it is left alone.
  void measure(std::uint64_t picture, std::vector<glm::vec4> radiance);
  /// The newest state where it is newer than `version`.
  [[nodiscard]] std::optional<ReferenceState> newer_than(std::uint64_t version) const;

 private:
  void work(const scene::Scene& scene, const scene::Camera& camera, glm::ivec2 size);
  void compare();

  std::thread thread_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_;
  ReferenceState state_;
  std::vector<glm::vec4> picture_;
  std::uint64_t picture_id_ = 0;
};

}  // namespace loom::viewer
