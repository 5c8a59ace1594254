#pragma once
// The real spherical harmonics in a unit direction up to band 3, without the Condon–Shortley phase, Y_lm at l² + l + m.
// shaders/lib/sh_basis.glsl is the same in GLSL.
#include <array>

#include <glm/vec3.hpp>

namespace prt {

inline std::array<double, 16> harmonics(const glm::dvec3& w) {
  const double x = w.x, y = w.y, z = w.z;
  return {.28209479177387814,
          .48860251190291992 * y,
          .48860251190291992 * z,
          .48860251190291992 * x,
          1.0925484305920792 * x * y,
          1.0925484305920792 * y * z,
          .31539156525252005 * (3 * z * z - 1),
          1.0925484305920792 * x * z,
          .54627421529603959 * (x * x - y * y),
          .59004358992664352 * y * (3 * x * x - y * y),
          2.8906114426405538 * x * y * z,
          .45704579946446572 * y * (5 * z * z - 1),
          .37317633259011540 * z * (5 * z * z - 3),
          .45704579946446572 * x * (5 * z * z - 1),
          1.4453057213202769 * z * (x * x - y * y),
          .59004358992664352 * x * (x * x - 3 * y * y)};
}

}  // namespace prt
