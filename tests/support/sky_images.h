#pragma once
// Skies with known answers.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/sky.h"

namespace loom::test {

/// L(ω) = a + b·⟨axis, ω⟩, bands 0 and 1 alone; `axis` unit.
inline scene::SkyImage sky_of_two_bands(double a, const glm::dvec3& b, const glm::dvec3& axis, int height = 64) {
  scene::SkyImage image{.width = 2 * height, .height = height};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 w = scene::SkyImage::direction_of({(x + .5) / image.width, (y + .5) / image.height});
      image.radiance.emplace_back(glm::dvec3(a) + b * glm::dot(axis, w));
    }
  }
  return image;
}

/// The irradiance of that sky on an unblocked plane: ∫ (a + b⟨axis,ω⟩)⟨n,ω⟩₊ dω = πa + 2π/3·b⟨axis,n⟩.
inline glm::dvec3 irradiance_of_two_bands(double a, const glm::dvec3& b, const glm::dvec3& axis, const glm::dvec3& n) {
  constexpr double pi = std::numbers::pi;
  return glm::dvec3(pi * a) + 2 * pi / 3 * b * glm::dot(axis, n);
}

}  // namespace loom::test
