#pragma once
// Pairwise covers: few rows of settings in which every two values of two parameters meet.
#include <cstdint>
#include <functional>
#include <vector>

#include "loom/export.h"

namespace loom::measure {

/// One pair of values, of two parameters: `a` before `b`.
struct ValuePair {
  int a = 0, value_a = 0, b = 0, value_b = 0;
};

/// Rows with one value for each parameter, 0 … counts[i]−1, such that every pair of values for which `wanted` holds is
/// in some row. Greedy: each row begins with a pair that is still missing, and every other parameter, in random order,
/// takes the value that brings most missing pairs.
LOOM_API std::vector<std::vector<int>> pairwise_cover(const std::vector<int>& counts, std::uint32_t seed,
                                                      const std::function<bool(const ValuePair&)>& wanted);

}  // namespace loom::measure
