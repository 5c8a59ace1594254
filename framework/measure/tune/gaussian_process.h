#pragma once
// Regression that knows how sure it is (Rasmussen and Williams 2006, algorithm 2.1).
#include <functional>
#include <vector>

#include "loom/export.h"

namespace loom::measure {

struct Guess {
  double mean = 0, sd = 0;
};

/// A covariance between the i-th and the k-th of all candidates.
using Kernel = std::function<double(std::size_t, std::size_t)>;

/// The values seen at `at` (indices of candidates), with independent errors of standard deviation `noise`; between
/// them the kernel decides. Around the mean of what was seen.
class LOOM_API GaussianProcess {
 public:
  GaussianProcess(Kernel kernel, std::vector<std::size_t> at, const std::vector<double>& values, double noise);
  [[nodiscard]] Guess at(std::size_t candidate) const;

 private:
  Kernel kernel_;
  std::vector<std::size_t> at_;
  std::vector<std::vector<double>> lower_;  ///< Cholesky factor of the covariance of what was seen
  std::vector<double> weights_;
  double mean_ = 0;
};

}  // namespace loom::measure
