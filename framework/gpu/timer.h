#pragma once
// GPU time of consecutive spans, read some frames later, so that nothing waits for the GPU.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace loom::gpu {

/// Marks between spans: n+1 marks a frame measure n spans.
class SpanTimer {
 public:
  /// `settle`: finish all work at each mark. A CPU rasteriser (llvmpipe) runs compute at the call but queues drawing
  /// and the marks themselves, so that without it time lands in the wrong span; there it costs little, on a GPU much.
  SpanTimer(std::size_t spans, bool settle);
  ~SpanTimer();
  SpanTimer(const SpanTimer&) = delete;
  SpanTimer& operator=(const SpanTimer&) = delete;

  void begin_frame();
  /// The end of one span and the beginning of the next; the first of a frame begins span 0.
  void mark();
  /// Hands the milliseconds of each span to `done`, frame by frame, oldest first. A frame whose marks the GPU has not
  /// reached is left for later; with `wait`, waited for.
  using Done = std::function<void(std::span<const double> span_ms)>;
  void collect(bool wait, const Done& done);

 private:
  struct FrameMarks {
    std::vector<unsigned int> queries;
    bool pending = false;
  };
  std::vector<FrameMarks> frames_;  ///< ring
  std::size_t current_ = 0, next_mark_ = 0;
  bool settle_ = false;
  void* context_ = nullptr;
};

}  // namespace loom::gpu
