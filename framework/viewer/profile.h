#pragma once
// What the last frames cost, pass by pass.
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "graph/run/renderer.h"

namespace loom::viewer {

struct ProfiledFrame {
  std::uint64_t index = 0;
  double start_s = 0;  ///< of any steady clock
  std::vector<graph::PassCost> passes;
  [[nodiscard]] double gpu_ms() const;
};

class Profile {
 public:
  static constexpr std::size_t capacity = 512;
  void add(ProfiledFrame frame);
  [[nodiscard]] const std::deque<ProfiledFrame>& frames() const { return frames_; }
  /// Chrome's trace format (chrome://tracing, Perfetto): one track of the GPU, one of the CPU. The timers give how long
  /// a pass took and not when it began, so passes of a frame are laid end to end from the frame's start.
  [[nodiscard]] std::string chrome_trace() const;

 private:
  std::deque<ProfiledFrame> frames_;
};

}  // namespace loom::viewer
