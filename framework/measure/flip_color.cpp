#include "measure/flip_color.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/matrix.hpp>

namespace loom::measure::flip {
namespace {

/// Column of X, Y, Z at Y = 1 of a chromaticity.
glm::dvec3 xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// Primaries of ITU-R BT.709; D65 to the five digits that both papers use.
glm::dmat3 relative_matrix() {
  const glm::dmat3 primaries(xyz_of(.64, .33), xyz_of(.30, .60), xyz_of(.15, .06));
  const glm::dvec3 white = xyz_of(.31271, .32902);
  const glm::dvec3 amounts = glm::inverse(primaries) * white;
  glm::dmat3 matrix;
  for (int column = 0; column < 3; ++column) matrix[column] = primaries[column] * amounts[column] / white;
  return matrix;
}

/// CIE 15: cube root above (6/29)³, its tangent below.
float lab_curve(float t) {
  constexpr float knee = 6.f / 29.f;
  return t > knee * knee * knee ? std::cbrt(t) : t / (3 * knee * knee) + 4.f / 29.f;
}

// LDR paper, section 4.3: exponent, and the knee that gives most of the range to the distances that occur in
// renderings.
constexpr float exponent = .7f;
constexpr float knee_distance = .4f;
constexpr float knee_error = .95f;

/// Between the farthest colours of Rec.709: green and blue.
float largest_distance() {
  const glm::mat3& m = relative_xyz_from_rgb();
  return std::pow(hyab(hunt_lab(m * glm::vec3(0, 1, 0)), hunt_lab(m * glm::vec3(0, 0, 1))), exponent);
}

/// (a·x² + b·x)/(c·x² + d·x + e) of Narkowicz's fit (2.51, .03, 2.43, .59, .14) at .6·x.
constexpr double pre = .6;
constexpr double a = 2.51 * pre * pre, b = .03 * pre, c = 2.43 * pre * pre, d = .59 * pre, e = .14;

}  // namespace

const glm::mat3& relative_xyz_from_rgb() {
  static const glm::mat3 matrix(relative_matrix());
  return matrix;
}

const glm::mat3& rgb_from_relative_xyz() {
  static const glm::mat3 matrix(glm::inverse(relative_matrix()));
  return matrix;
}

glm::vec3 hunt_lab(glm::vec3 n) {
  const glm::vec3 f(lab_curve(n.x), lab_curve(n.y), lab_curve(n.z));
  const float lightness = 116 * f.y - 16;
  const float hunt = .01f * lightness;
  return {lightness, hunt * 500 * (f.x - f.y), hunt * 200 * (f.y - f.z)};
}

float hyab(glm::vec3 lab1, glm::vec3 lab2) {
  const glm::vec3 difference = lab1 - lab2;
  return std::abs(difference.x) + std::sqrt(difference.y * difference.y + difference.z * difference.z);
}

float redistribute(float distance) {
  static const float largest = largest_distance();
  const float error = std::pow(distance, exponent);
  const float knee = knee_distance * largest;
  if (error < knee) return error * knee_error / knee;
  return std::min(1.f, knee_error + (error - knee) / (largest - knee) * (1 - knee_error));
}

double aces(double x) { return (a * x * x + b * x) / (c * x * x + d * x + e); }

double aces_inverse(double t) {
  const double p = a - t * c, q = b - t * d, r = -t * e;
  return (-q + std::sqrt(q * q - 4 * p * r)) / (2 * p);
}

void aces_row(std::span<float> values, float exposure_factor) {
  // The curve is over 1 from 7.3 on, so that a clamp here only keeps the square in range of a float.
  constexpr float enough = 1e4f;
  constexpr auto fa = static_cast<float>(a), fb = static_cast<float>(b), fc = static_cast<float>(c),
                 fd = static_cast<float>(d), fe = static_cast<float>(e);
  for (float& value : values) {
    const float x = std::min(std::max(value * exposure_factor, 0.f), enough);
    value = std::min((fa * x + fb) * x / ((fc * x + fd) * x + fe), 1.f);
  }
}

}  // namespace loom::measure::flip
