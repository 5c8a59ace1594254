#pragma once
// How samples are weighed, and when weak ones end.
#include <algorithm>

#include <glm/vec3.hpp>

namespace loom::reference {

/// Paths weaker than this play roulette, and go on with this weight. Measured on the Cornell box: error² × rays is
/// least near a half (1 costs a third more, a quarter a tenth).
inline constexpr float least_weight = .5F;
/// Highest chance to go on. Second moments stay finite while ρ² < this, and a path in a white box still ends.
inline constexpr float most_survival = 1 - 0x1p-10F;

/// Power heuristic with exponent 2 (Veach 1995), for a sample of density `own` that the other way finds with density
/// `other`.
inline float power_heuristic(float own, float other) {
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

inline float largest(const glm::vec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

}  // namespace loom::reference
