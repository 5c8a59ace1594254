#include "graph/run/statistics.h"

#include <algorithm>
#include <cmath>

namespace loom::graph {

void Samples::add(double value) {
  if (values_.size() < capacity)
    values_.push_back(value);
  else
    values_[count_ % capacity] = value;
  ++count_;
}

double Samples::quantile(double q) const {
  if (values_.empty()) return 0;
  const bool warm = count_ > 1 && count_ <= capacity;
  std::vector<double> sorted(values_.begin() + (warm ? 1 : 0), values_.end());
  // Linear between neighbours, so that the median of an even count is the mean of the middle two.
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(position));
  std::sort(sorted.begin(), sorted.end());
  const double upper = sorted[std::min(below + 1, sorted.size() - 1)];
  return sorted[below] + (position - static_cast<double>(below)) * (upper - sorted[below]);
}

}  // namespace loom::graph
