#include "cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace loom::cli {

Progress::Progress(std::string label, std::uint64_t total)
    : label_(std::move(label)), total_(total), terminal_(isatty(STDERR_FILENO) == 1), start_(Clock::now()) {}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::show(std::uint64_t done) {
  const Clock::time_point now = Clock::now();
  if (!terminal_ || done == 0 || total_ == 0 || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = elapsed * static_cast<double>(total_ - done) / static_cast<double>(done);
  constexpr std::uint64_t width = 24;
  std::string bar(width, ' ');
  std::fill_n(bar.begin(), std::min(done, total_) * width / total_, '=');
  std::fprintf(stderr, "\r\033[K[%s] %s %llu/%llu, %.0f s left", bar.c_str(), label_.c_str(),
               static_cast<unsigned long long>(done), static_cast<unsigned long long>(total_), left);
}

}  // namespace loom::cli
