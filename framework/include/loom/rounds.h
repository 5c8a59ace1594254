#pragma once
// How much one shader invocation may do. Mesa's llvmpipe ends an invocation after 65535 rounds of all its loops
// together (LP_MAX_TGSI_LOOP_ITERATIONS), without a word; other drivers reset a device that one dispatch keeps for too
// long. So what a parameter can make larger than that is done in several dispatches.
#include <algorithm>

namespace loom {

inline constexpr int most_rounds = 65535;

/// How many of `count` equal steps one dispatch does, where each takes `rounds` rounds of inner loops at most.
inline int steps_at_once(int count, int rounds) {
  return std::clamp(most_rounds / (rounds + 1), 1, std::max(count, 1));
}

}  // namespace loom
