#pragma once
// A progress bar on stderr, with the time that is left. Only where stderr is a terminal.
#include <chrono>
#include <cstdint>
#include <string>

namespace loom::cli {

class Progress {
 public:
  Progress(std::string label, std::uint64_t total);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< clears the line
  /// `done` of `total` steps are done.
  void show(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::uint64_t total_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_, last_;
};

}  // namespace loom::cli
