#include "reference/ggx.h"

#include <array>
#include <cstddef>

#include <glm/common.hpp>

namespace loom::reference {
namespace {

constexpr int side = GGX_TABLE_SIDE;

/// A and B of E = F₀·A + F₉₀·B at table position (x, y), in cells.
glm::vec2 split(float x, float y) {
  const int i = std::min(static_cast<int>(x), side - 2);
  const int j = std::min(static_cast<int>(y), side - 2);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  const auto at = [&](int row, int column) {
    const auto k = static_cast<std::size_t>(2 * (row * side + column));
    return glm::vec2(interop::ggx_table[k], interop::ggx_table[k + 1]);
  };
  return glm::mix(glm::mix(at(i, j), at(i, j + 1), fy), glm::mix(at(i + 1, j), at(i + 1, j + 1), fy), fx);
}

float place(float value) { return std::sqrt(std::clamp(value, 0.F, 1.F)) * (side - 1); }

}  // namespace

glm::vec3 ggx_albedo(float mu, float alpha, const glm::vec3& f0) {
  const glm::vec2 s = split(place(mu), place(alpha));
  return f0 * s.x + ggx_f90(f0) * s.y;
}

glm::vec3 ggx_mean_albedo(float alpha, const glm::vec3& f0) {
  // 2∫ E μ dμ with μ = t²: ∫ 4 E t³ dt. Between rows E is linear in t, so that three points a cell are exact.
  static const std::array<glm::vec2, side> means = [] {
    std::array<glm::vec2, side> result{};
    constexpr std::array<float, 3> points{-.7745967F, 0, .7745967F}, weights{5.F / 9, 8.F / 9, 5.F / 9};
    for (int column = 0; column < side; ++column) {
      for (int row = 0; row + 1 < side; ++row) {
        for (std::size_t k = 0; k < points.size(); ++k) {
          const float x = static_cast<float>(row) + (1 + points.at(k)) / 2;
          const float t = x / (side - 1);
          result.at(static_cast<std::size_t>(column)) +=
              split(x, static_cast<float>(column)) * (4 * t * t * t * weights.at(k) / 2 / (side - 1));
        }
      }
    }
    return result;
  }();
  const float y = place(alpha);
  const auto j = static_cast<std::size_t>(std::min(static_cast<int>(y), side - 2));
  const glm::vec2 s = glm::mix(means.at(j), means.at(j + 1), y - static_cast<float>(j));
  return f0 * s.x + ggx_f90(f0) * s.y;
}

}  // namespace loom::reference
