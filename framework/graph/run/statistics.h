#pragma once
// Medians and percentiles over the last frames.
#include <cstddef>
#include <vector>

namespace loom::graph {

class Samples {
 public:
  void add(double value);
  /// The first sample is warm-up and left out where there are more. 0 without samples.
  [[nodiscard]] double median() const { return quantile(.5); }
  [[nodiscard]] double quantile(double q) const;
  [[nodiscard]] double last() const { return count_ == 0 ? 0 : values_[(count_ - 1) % capacity]; }

 private:
  // Some minutes at 60 frames a second; older ones are overwritten.
  static constexpr std::size_t capacity = 8192;
  std::vector<double> values_;
  std::size_t count_ = 0;
};

}  // namespace loom::graph
