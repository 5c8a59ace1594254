#include "cli/stress_child.h"

#include <fmt/core.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "gpu/context.h"
#include "gpu/device.h"
#include "loom/diagnostic.h"
#include "measure/stress_report.h"

namespace loom::cli {
namespace {

using measure::StressCase;
using measure::StressOutcome;
using measure::StressResult;

/// Drivers keep what they compiled: a child that has seen this many cases makes room for another.
constexpr std::size_t cases_of_a_child = 200;

void send(int to, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = write(to, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) _exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void be_child(int to, std::span<const StressCase* const> cases, const Registry& registry,
                           const plugins::SearchPath& search, const measure::StressLimits& limits) {
  try {
    const gpu::Context context = gpu::Context::headless();
    const auto device = gpu::CachingDevice::create({.shader_roots = plugins::shader_roots(search), .cache_dir = {}});
    for (const StressCase* what : cases) {
      send(to, measure::to_line(what->id(), run_stress(*what, registry, *device, limits)));
    }
  } catch (const std::exception& error) {
    send(to, measure::to_line(cases.front()->id(), {StressOutcome::broken, error.what()}));
  }
  // The parent's buffers and threads are not the child's to end.
  _exit(0);
}

/// A child and what it says, line by line.
class Child {
 public:
  Child(std::span<const StressCase* const> cases, const Registry& registry, const plugins::SearchPath& search,
        const measure::StressLimits& limits) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw Error(std::string("cannot make a pipe: ") + std::strerror(errno));
    pid_ = fork();
    if (pid_ < 0) throw Error(std::string("cannot start a process: ") + std::strerror(errno));
    if (pid_ == 0) {
      close(ends[0]);
      be_child(ends[1], cases, registry, search, limits);
    }
    close(ends[1]);
    from_ = ends[0];
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) (void)end(true);
    close(from_);
  }

  enum class Heard { line, nothing_more, nothing_in_time };
  Heard listen(double seconds, std::string& line) {
    using Clock = std::chrono::steady_clock;
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    std::array<char, 4096> part{};
    for (;;) {
      if (const std::size_t end = text_.find('\n'); end != std::string::npos) {
        line = text_.substr(0, end);
        text_.erase(0, end + 1);
        return Heard::line;
      }
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
      pollfd waiting{.fd = from_, .events = POLLIN, .revents = 0};
      const int ready = left > 0 ? poll(&waiting, 1, static_cast<int>(left)) : 0;
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0) return Heard::nothing_in_time;
      const ssize_t count = read(from_, part.data(), part.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return Heard::nothing_more;
      text_.append(part.data(), static_cast<std::size_t>(count));
    }
  }

  /// Waits for its end (which is now, where it is killed). Its status as waitpid() has it.
  int end(bool killed) {
    if (killed) kill(pid_, SIGKILL);
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
  int from_ = -1;
  std::string text_;
};

}  // namespace

void run_in_children(const std::vector<const StressCase*>& cases, const Registry& registry,
                     const plugins::SearchPath& search, const measure::StressLimits& limits, double seconds,
                     const std::function<void(const StressCase&, const StressResult&)>& done) {
  std::size_t at = 0;
  while (at < cases.size()) {
    const std::size_t first = at;
    const auto batch = std::span(cases).subspan(first, std::min(cases.size() - first, cases_of_a_child));
    Child child(batch, registry, search, limits);
    while (at < first + batch.size()) {
      std::string line;
      const Child::Heard heard = child.listen(seconds, line);
      const auto result = heard == Child::Heard::line ? measure::from_line(line) : std::nullopt;
      if (result && result->first == cases[at]->id()) {
        done(*cases[at++], result->second);
        continue;
      }
      const bool late = heard == Child::Heard::nothing_in_time;
      const int status = child.end(late);
      if (late) {
        done(*cases[at++], {StressOutcome::skipped, fmt::format("not done within {:g} s", seconds)});
      } else {
        done(*cases[at++], {StressOutcome::broken, WIFSIGNALED(status)
                                                       ? fmt::format("the process ended by signal {}", WTERMSIG(status))
                                                       : std::string("the process ended without an answer")});
      }
      break;
    }
  }
}

}  // namespace loom::cli
