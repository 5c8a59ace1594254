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

/// How many dispatches they take.
inline int parts_of(int count, int rounds) {
  const int at_once = steps_at_once(count, rounds);
  return std::max(1, (count + at_once - 1) / at_once);
}

/// Rounds of a ray through the BVH: some hundred where the scene is large.
inline constexpr int rounds_of_traced_ray = 1000;

/// Rounds of a ray through a voxelized scene that can cross so many cells. In an occupied one it looks at three sheets
/// twice, and the eight lanes of a SIMD group, which count together, find theirs at different times.
inline int rounds_of_marched_ray(int cells) { return 8 * cells; }

}  // namespace loom
