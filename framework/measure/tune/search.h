#pragma once
// Finds the cheapest setting that is accurate enough, or the most accurate that is cheap enough, from few measurements.
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "loom/export.h"

namespace loom::measure {

/// A place in the grid of a pipeline.
struct Candidate {
  std::string pipeline;
  std::map<std::string, double> knobs;  ///< "pass.param" → its value's rank among those tried, 0 … 1
};

struct Observation {
  double time_ms = 0;
  double error = 0;  ///< relMSE; infinite where it could not be measured
};

/// One of the two.
struct Promise {
  std::optional<double> max_error, budget_ms;
  [[nodiscard]] bool kept(const Observation& o) const {
    return max_error ? o.error <= *max_error : o.time_ms <= *budget_ms;
  }
  /// What is to be small once the promise is kept.
  [[nodiscard]] double value(const Observation& o) const { return max_error ? o.time_ms : o.error; }
};

struct Search {
  std::map<std::size_t, Observation> seen;  ///< by candidate; what is in it beforehand counts as known
  std::optional<std::size_t> best;          ///< keeps the promise, with the least value
  std::optional<std::size_t> nearest;       ///< comes nearest to keeping it
};

/// Measures at most `evaluations` more candidates. Bayesian optimisation under a constraint (Gardner et al. 2014): two
/// Gaussian processes, over the logarithms of time and error, learn from every measurement what the pipelines and the
/// knobs do; the next candidate is the one of the largest expected improvement times probability of keeping the
/// promise. Half of the measurements go first to pipelines without knobs and to the middles of the grids, the largest
/// ones in front; the last go to where some improvement is likeliest. Ends early where nothing better is to be
/// expected. Deterministic.
LOOM_API void search(const std::vector<Candidate>& candidates, const Promise& promise, std::size_t evaluations,
                     const std::function<Observation(std::size_t)>& measure, Search& search);

}  // namespace loom::measure
