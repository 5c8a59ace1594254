#pragma once
// The real spherical harmonics in double precision, without the Condon–Shortley phase, Y_lm at l² + l + m; up to band 3
// they are what shaders/lib/sh_basis.glsl has.
#include <vector>

#include <glm/vec3.hpp>

#include "loom/export.h"

namespace loom {

inline constexpr int max_harmonic_order = 8;

/// All (order+1)² of them in a unit direction; `order` within 0 and max_harmonic_order.
LOOM_API std::vector<double> harmonics(const glm::dvec3& w, int order);

/// `w` turned about +Y by an angle in radians, from +Z towards +X.
LOOM_API glm::dvec3 turned_about_y(const glm::dvec3& w, double angle);

/// The coefficients of f(R⁻¹ω) from those of f, R being turned_about_y(): what a function becomes that is turned. Bands
/// do not mix, R_ij = ∫ Y_i(Rω)·Y_j(ω) dω. `coefficients` holds a square number of them, up to max_harmonic_order.
LOOM_API std::vector<glm::dvec3> turned_about_y(const std::vector<glm::dvec3>& coefficients, double angle);

}  // namespace loom
