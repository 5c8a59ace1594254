#pragma once
#include <cmath>
#include <cstddef>

#include "support/bench.h"

namespace loom::test {

/// Root of the mean square of a − b, over that of b; where b is black, of a alone.
inline double distance(const Texels& a, const Texels& b) {
  double difference = 0, square = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double x = a.values[i][c], y = b.values[i][c];
      difference += (x - y) * (x - y);
      square += y * y;
    }
  }
  return square > 0 ? std::sqrt(difference / square) : std::sqrt(difference);
}

}  // namespace loom::test
