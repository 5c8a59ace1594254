#pragma once
// The colour spaces of FLIP: linear Rec.709, its white-relative tristimulus values, CIELab with Hunt's effect, and the
// ACES tone curve.
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace loom::measure::flip {

/// n = (X/Xn, Y/Yn, Z/Zn) of linear Rec.709 under its own white, D65. White is (1, 1, 1). n.y is relative luminance.
const glm::mat3& relative_xyz_from_rgb();
const glm::mat3& rgb_from_relative_xyz();

/// CIELab with chroma scaled by the Hunt effect (a, b times L/100: colour is the stronger the brighter it is seen).
glm::vec3 hunt_lab(glm::vec3 relative_xyz);
/// |ΔL| + √(Δa²+Δb²): HyAB, for distances too large for Euclid's.
float hyab(glm::vec3 lab1, glm::vec3 lab2);
/// Maps a HyAB distance to 0 … 1: to the power .7; what is below .4 of the largest fills 0 … .95, the rest .95 … 1.
float redistribute(float distance);

/// ACES filmic curve, Narkowicz's fit behind its usual pre-exposure of .6. Not clamped: tends to 1.033.
double aces(double x);
/// The x > 0 with aces(x) = t.
double aces_inverse(double t);
/// The same for a row of exposed values in place, clamped to [0,1]; negative values count as 0.
void aces_row(std::span<float> values, float exposure_factor);

}  // namespace loom::measure::flip
