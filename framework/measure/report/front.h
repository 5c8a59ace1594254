#pragma once
// What a cloud of measured settings says: which are worth having, and what accuracy costs.
#include <string>
#include <vector>

#include "loom/export.h"
#include "measure/sweep/result.h"

namespace loom::measure {

/// Of each: nothing else is both at least as cheap and at least as accurate, and better in one. NaN never is.
LOOM_API std::vector<bool> pareto_front(const std::vector<double>& cost, const std::vector<double>& error);

/// 1, 2 and 5 times powers of ten from the first at or above `low` to the last at or below `high`.
LOOM_API std::vector<double> round_steps(double low, double high);

/// A parameter that is no knob of accuracy: with all others held, the error first falls and then rises on the way from
/// its lowest to its highest value, or the other way round, by more than the seeds scatter.
struct OddKnob {
  std::string scene, pipeline, param;
  std::string with;                 ///< the other parameters, "a.b=1 c.d=2"
  std::vector<std::string> values;  ///< ascending
  std::vector<double> errors;       ///< relMSE of hdr
  std::vector<std::string> keys;
};
LOOM_API std::vector<OddKnob> odd_knobs(const std::vector<Result>& results);

}  // namespace loom::measure
