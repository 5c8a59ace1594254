#include "measure/tune/gaussian_process.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace loom::measure {
namespace {

using Rows = std::vector<std::vector<double>>;

/// Solves L·x = b, then with `transposed` Lᵀ·x = b.
std::vector<double> solve(const Rows& lower, std::vector<double> b, bool transposed) {
  const std::size_t n = b.size();
  for (std::size_t step = 0; step < n; ++step) {
    const std::size_t i = transposed ? n - 1 - step : step;
    for (std::size_t done = 0; done < step; ++done) {
      const std::size_t k = transposed ? n - 1 - done : done;
      b[i] -= (transposed ? lower[k][i] : lower[i][k]) * b[k];
    }
    b[i] /= lower[i][i];
  }
  return b;
}

}  // namespace

GaussianProcess::GaussianProcess(Kernel kernel, std::vector<std::size_t> at, const std::vector<double>& values,
                                 double noise)
    : kernel_(std::move(kernel)), at_(std::move(at)) {
  const std::size_t n = at_.size();
  mean_ = n == 0 ? 0 : std::accumulate(values.begin(), values.end(), 0.) / static_cast<double>(n);
  lower_.assign(n, std::vector<double>(n, 0));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      double sum = kernel_(at_[i], at_[k]) + (i == k ? noise * noise : 0);
      for (std::size_t j = 0; j < k; ++j) sum -= lower_[i][j] * lower_[k][j];
      lower_[i][k] = i == k ? std::sqrt(std::max(sum, 1e-12)) : sum / lower_[k][k];
    }
  }
  std::vector<double> deviations(n);
  for (std::size_t i = 0; i < n; ++i) deviations[i] = values[i] - mean_;
  weights_ = solve(lower_, solve(lower_, std::move(deviations), false), true);
}

Guess GaussianProcess::at(std::size_t candidate) const {
  std::vector<double> covariance(at_.size());
  Guess guess{.mean = mean_};
  for (std::size_t i = 0; i < at_.size(); ++i) {
    covariance[i] = kernel_(candidate, at_[i]);
    guess.mean += covariance[i] * weights_[i];
  }
  const std::vector<double> known = solve(lower_, std::move(covariance), false);
  double variance = kernel_(candidate, candidate);
  for (const double k : known) variance -= k * k;
  guess.sd = std::sqrt(std::max(variance, 1e-12));
  return guess;
}

}  // namespace loom::measure
