#include "reference/run.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "loom/diagnostic.h"

namespace loom::reference {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A band of rows takes about this long: what a kill can lose beside the checkpoint's interval, and how soon a report
/// follows a report.
constexpr double band_s = .25;
constexpr double largest_save_share = .05;

std::uint32_t whole_rounds(double samples) {
  const double rounds = std::ceil(std::max(samples, 1.) / replicates);
  constexpr double most = std::numeric_limits<std::uint32_t>::max() / replicates;
  return static_cast<std::uint32_t>(std::min(rounds, most)) * replicates;
}

class Run {
 public:
  Run(const PathTracer& tracer, Film& film, const interop::Camera& camera, const Target& target,
      const Checkpoint& checkpoint, const std::function<bool(const Progress&)>& report)
      : tracer_(tracer), film_(film), camera_(camera), target_(target), checkpoint_(checkpoint), report_(report) {}

  void operator()() {
    first_ = film_.least_count();
    done_ = first_ / replicates * replicates;
    if (done_ > 0) measure();
    // An interrupted round is ended first: the run must stop where it would have stopped without the interruption.
    bool whole = first_ == done_ && film_.most_count() == done_;
    while (!whole || !reached()) {
      if (!round()) break;
      done_ += replicates;
      whole = true;
      if (measures_at(done_)) measure();
    }
    if (changed_) {
      measure();
      save();
    }
    tell(0);
  }

 private:
  [[nodiscard]] bool reached() const {
    if (target_.samples) return done_ >= whole_rounds(*target_.samples);
    return target_.noise && progress_.noise && measures_at(done_) && *progress_.noise <= *target_.noise;
  }

  /// The error falls with the root of the samples: looking after each sixteenth more is enough. Depends on the samples
  /// alone, so that an interruption does not move the end.
  static bool measures_at(std::uint32_t samples) {
    const std::uint32_t rounds = samples / replicates;
    return rounds % std::max(1U, std::bit_floor(rounds) / 16) == 0;
  }

  /// One more sample of each replicate in every pixel. False where the caller wants to end.
  bool round() {
    const int height = film_.size().y;
    for (int row = 0; row < height;) {
      const int last = std::min(height, row + rows_);
      const auto start = Clock::now();
      tracer_.accumulate(film_, camera_, done_ + replicates, row, last);
      const double took = seconds_since(start);
      film_.seconds += took;
      changed_ = true;
      const double wanted = (last - row) * band_s / std::max(took, 1e-6);
      // At most twice as many as before: the first band pays for starting the threads.
      rows_ = std::clamp(static_cast<int>(std::min(wanted, 2. * rows_)), 1, height);
      row = last;
      if (!checkpoint_.path.empty() && seconds_since(saved_) > std::max(checkpoint_.every_s, save_s_)) save();
      if (!tell(static_cast<double>(row) / height)) return false;
    }
    return true;
  }

  void measure() {
    progress_.noise = film_.relative_error();
    progress_.measured_at = done_;
  }

  void save() {
    if (checkpoint_.path.empty()) return;
    const auto start = Clock::now();
    film_.save(checkpoint_.path);
    saved_ = Clock::now();
    save_s_ = seconds_since(start) / largest_save_share;
    changed_ = false;
  }

  /// `row_share`: of the rows, how many have the next round too. False where the caller wants to end.
  bool tell(double row_share) {
    if (!report_) return true;
    const double now = done_ + row_share * replicates;
    progress_.samples = done_;
    progress_.seconds = seconds_since(start_);
    progress_.rays_per_s = static_cast<double>(film_.rays - rays_before_) / std::max(progress_.seconds, 1e-9);
    progress_.expected = 0;
    if (target_.samples) {
      progress_.expected = whole_rounds(*target_.samples);
    } else if (target_.noise && progress_.noise) {
      const double ratio = *progress_.noise / *target_.noise;
      progress_.expected = whole_rounds(std::max(now, progress_.measured_at * ratio * ratio));
    }
    progress_.fraction = progress_.expected == 0 ? 0 : std::min(1., now / progress_.expected);
    const double rate = (now - first_) / std::max(progress_.seconds, 1e-9);
    if (progress_.expected > 0 && rate > 0) progress_.remaining_s = (progress_.expected - now) / rate;
    return report_(progress_);
  }

  const PathTracer& tracer_;
  Film& film_;
  const interop::Camera& camera_;
  const Target& target_;
  const Checkpoint& checkpoint_;
  const std::function<bool(const Progress&)>& report_;
  Progress progress_;
  Clock::time_point start_ = Clock::now(), saved_ = start_;
  std::uint64_t rays_before_ = film_.rays;
  std::uint32_t first_ = 0, done_ = 0;
  double save_s_ = 0;
  int rows_ = 4;
  bool changed_ = false;
};

}  // namespace

void run(const PathTracer& tracer, Film& film, const interop::Camera& camera, const Target& target,
         const Checkpoint& checkpoint, const std::function<bool(const Progress&)>& report) {
  if (!target.samples && !target.noise) throw Error("a run needs a target: samples or noise");
  Run(tracer, film, camera, target, checkpoint, report)();
}

Film open_film(const std::string& path, glm::ivec2 size, const FilmIdentity& identity, std::uint64_t seed) {
  if (!std::filesystem::exists(path)) return {size, identity, seed};
  Film film = Film::load(path);
  const auto refuse = [&](const std::string& why, const std::string& hint) {
    Diagnostic diagnostic;
    diagnostic.code = "film-differs";
    diagnostic.message = "the accumulation '" + path + "' cannot be continued: " + why;
    diagnostic.where.file = path;
    diagnostic.hint = hint;
    throw BadInput(diagnostic);
  };
  if (film.size() != size || !(film.identity() == identity)) {
    refuse("it is of another scene, camera, size or number of bounces",
           "delete it to start again, or choose another -o");
  }
  if (film.seeds().size() != 1) refuse("it is a merged one", "render on with another -o and --seed, then merge again");
  if (film.seeds().front() != seed) {
    refuse("it was begun with --seed " + std::to_string(film.seeds().front()),
           "give that seed, or another -o and merge the two");
  }
  return film;
}

}  // namespace loom::reference
