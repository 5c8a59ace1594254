#include "measure/tune/search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "measure/tune/gaussian_process.h"

namespace loom::measure {
namespace {

// In natural logarithms. Pipelines differ by orders of magnitude, a knob by less from end to end; a measured time
// scatters by some per cent.
constexpr double pipeline_sd = 1.5;
constexpr double trend_sd = .5;      // of a knob's slope that all pipelines share
constexpr double shape_sd = .4;      // of what a pipeline does with its knobs besides
constexpr double shape_length = .7;  // in ranks, over which that changes
constexpr double noise_sd = .05;
/// The last of the measurements, one in so many, go to where an improvement by this share is likeliest, and no more to
/// where a large one is barely possible.
constexpr std::size_t surest_share = 4;
constexpr double worthwhile = .03;
/// An expected improvement below this share is not worth a measurement.
constexpr double least_gain = .003;

double normal_density(double z) { return std::exp(-.5 * z * z) / std::sqrt(2 * std::numbers::pi); }
double normal_below(double z) { return .5 * std::erfc(-z / std::numbers::sqrt2); }

double covariance(const Candidate& a, const Candidate& b) {
  double sum = 0, distance = 0;
  for (const auto& [name, rank] : a.knobs) {
    const auto other = b.knobs.find(name);
    if (other == b.knobs.end()) continue;
    sum += trend_sd * trend_sd * (rank - .5) * (other->second - .5);
    distance += (rank - other->second) * (rank - other->second);
  }
  if (a.pipeline == b.pipeline) {
    sum += pipeline_sd * pipeline_sd + shape_sd * shape_sd * std::exp(-.5 * distance / (shape_length * shape_length));
  }
  return sum;
}

class Searcher {
 public:
  Searcher(const std::vector<Candidate>& candidates, const Promise& promise, Search& search)
      : candidates_(candidates), promise_(promise), search_(search) {}

  void run(std::size_t evaluations, const std::function<Observation(std::size_t)>& measure) {
    std::size_t first = (evaluations + 1) / 2;
    for (const std::size_t middle : middles()) {
      if (first == 0) break;
      if (search_.seen.contains(middle)) continue;
      see(middle, measure(middle));
      --first;
      --evaluations;
    }
    choose();
    const std::size_t surest = evaluations / surest_share;
    for (; evaluations > 0; --evaluations) {
      const std::optional<std::size_t> next = most_promising(evaluations <= surest ? Wanted::chance : Wanted::gain);
      if (!next) break;
      see(*next, measure(*next));
      choose();
    }
  }

 private:
  void see(std::size_t candidate, const Observation& o) { search_.seen[candidate] = o; }

  /// The candidate of each pipeline whose knobs are nearest to half-way; the largest grids first, where there is most
  /// to find.
  [[nodiscard]] std::vector<std::size_t> middles() const {
    struct Middle {
      std::size_t size = 0, candidate = 0;
      double distance = std::numeric_limits<double>::infinity();
    };
    std::map<std::string, Middle> nearest;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      Middle& middle = nearest[candidates_[i].pipeline];
      ++middle.size;
      double distance = 0;
      for (const auto& [name, rank] : candidates_[i].knobs) distance += (rank - .5) * (rank - .5);
      if (distance < middle.distance) {
        middle.distance = distance;
        middle.candidate = i;
      }
    }
    std::vector<Middle> order;
    order.reserve(nearest.size());
    for (const auto& [pipeline, middle] : nearest) order.push_back(middle);
    std::stable_sort(order.begin(), order.end(), [](const Middle& a, const Middle& b) {
      return std::pair(a.size > 1, b.size) < std::pair(b.size > 1, a.size);
    });
    std::vector<std::size_t> list;
    list.reserve(order.size());
    for (const Middle& middle : order) list.push_back(middle.candidate);
    return list;
  }

  void choose() {
    search_.best.reset();
    search_.nearest.reset();
    const auto distance = [&](const Observation& o) { return promise_.max_error ? o.error : o.time_ms; };
    for (const auto& [candidate, o] : search_.seen) {
      if (!std::isfinite(o.error)) continue;
      if (!search_.nearest || distance(o) < distance(search_.seen[*search_.nearest])) search_.nearest = candidate;
      if (!promise_.kept(o)) continue;
      if (!search_.best || promise_.value(o) < promise_.value(search_.seen[*search_.best])) search_.best = candidate;
    }
  }

  enum class Wanted : std::uint8_t { gain, chance };

  [[nodiscard]] std::optional<std::size_t> most_promising(Wanted wanted) const {
    std::vector<std::size_t> at;
    std::vector<double> times, errors;
    for (const auto& [candidate, o] : search_.seen) {
      if (!std::isfinite(o.error)) continue;
      at.push_back(candidate);
      times.push_back(std::log(std::max(o.time_ms, 1e-6)));
      errors.push_back(std::log(std::max(o.error, 1e-12)));
    }
    if (at.empty()) return untried();
    const Kernel kernel = [&](std::size_t i, std::size_t k) { return covariance(candidates_[i], candidates_[k]); };
    const GaussianProcess time(kernel, at, times, noise_sd), error(kernel, at, errors, noise_sd);
    const GaussianProcess& value = promise_.max_error ? time : error;
    const GaussianProcess& bounded = promise_.max_error ? error : time;
    const double bound = std::log(promise_.max_error ? *promise_.max_error : *promise_.budget_ms);
    std::optional<std::size_t> next;
    double most = search_.best ? least_gain : 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (search_.seen.contains(i)) continue;
      const Guess b = bounded.at(i);
      double gain = normal_below((bound - b.mean) / b.sd);
      if (search_.best) {
        // Of the logarithm: an improvement of one per cent is .01.
        const Guess v = value.at(i);
        const double best = std::log(promise_.value(search_.seen.at(*search_.best)));
        if (wanted == Wanted::chance) {
          gain *= normal_below((best - worthwhile - v.mean) / v.sd);
        } else {
          const double ahead = best - v.mean, z = ahead / v.sd;
          gain *= ahead * normal_below(z) + v.sd * normal_density(z);
        }
      }
      if (gain > most) {
        most = gain;
        next = i;
      }
    }
    return next;
  }

  [[nodiscard]] std::optional<std::size_t> untried() const {
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!search_.seen.contains(i)) return i;
    }
    return std::nullopt;
  }

  const std::vector<Candidate>& candidates_;
  const Promise& promise_;
  Search& search_;
};

}  // namespace

void search(const std::vector<Candidate>& candidates, const Promise& promise, std::size_t evaluations,
            const std::function<Observation(std::size_t)>& measure, Search& search) {
  Searcher(candidates, promise, search).run(evaluations, measure);
}

}  // namespace loom::measure
