#include "light_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/light.h"
#include "loom/facts.h"

namespace rsm {
namespace {

using glm::dvec3;
using glm::dvec4;
using loom::SceneFacts;
using loom::interop::Light;
using loom::interop::LightFace;

/// `forward` unit; right × up = −forward, as a camera has it, so that front faces stay front faces.
struct Basis {
  dvec3 right, up, forward;
};

Basis looking_along(const dvec3& forward, const dvec3& up_hint) {
  const dvec3 right = glm::normalize(glm::cross(forward, up_hint));
  return {right, glm::cross(right, forward), forward};
}

Basis looking_along(const dvec3& forward) {
  const dvec3 size = glm::abs(forward);
  const bool steep = size.y > .9 * glm::length(forward);
  return looking_along(glm::normalize(forward), steep ? dvec3(0, 0, 1) : dvec3(0, 1, 0));
}

/// Rows of the matrix that takes a world position to clip space.
glm::mat4 from_rows(const std::array<dvec4, 4>& rows) {
  glm::mat4 m(1);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      m[column][row] = static_cast<float>(rows.at(static_cast<std::size_t>(row))[column]);
    }
  }
  return m;
}

/// The affine function ⟨axis, x − origin⟩ + offset as a row.
dvec4 row(const dvec3& axis, const dvec3& origin, double offset = 0) { return {axis, offset - glm::dot(axis, origin)}; }

/// clip = (q_x z, q_y z, near, z): depth near/z keeps the relative precision of a float at every distance.
LightFace perspective_face(const Light& light, int index, const Basis& basis, double tangent, double near) {
  const dvec3 origin(light.position);
  LightFace face{};
  face.view_proj = from_rows({row(basis.right / tangent, origin), row(basis.up / tangent, origin), dvec4(0, 0, 0, near),
                              row(basis.forward, origin)});
  face.origin = glm::vec4(glm::vec3(light.position), static_cast<float>(index));
  face.right = glm::vec4(glm::vec3(basis.right * tangent), static_cast<float>(near));
  face.up = glm::vec4(glm::vec3(basis.up * tangent), 0);
  face.forward = glm::vec4(glm::vec3(basis.forward), light.position.w);
  return face;
}

/// A box along the light around everything. A thousandth on each side keeps what lies on the bounds inside.
LightFace directional_face(const Light& light, int index, const SceneFacts& facts) {
  const Basis basis = looking_along(dvec3(light.direction));
  const double diagonal = glm::length(facts.bounds_max - facts.bounds_min);
  const double margin = std::max(1e-3 * diagonal, 1e-9);
  dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  for (int corner = 0; corner < 8; ++corner) {
    const dvec3 p((corner & 1) != 0 ? facts.bounds_max.x : facts.bounds_min.x,
                  (corner & 2) != 0 ? facts.bounds_max.y : facts.bounds_min.y,
                  (corner & 4) != 0 ? facts.bounds_max.z : facts.bounds_min.z);
    const dvec3 local(glm::dot(p, basis.right), glm::dot(p, basis.up), glm::dot(p, basis.forward));
    low = glm::min(low, local);
    high = glm::max(high, local);
  }
  low -= margin;
  high += margin;
  const dvec3 half = .5 * (high - low), middle = .5 * (high + low);
  const dvec3 origin = basis.right * middle.x + basis.up * middle.y + basis.forward * low.z;
  const double range = high.z - low.z;
  LightFace face{};
  face.view_proj = from_rows({row(basis.right / half.x, origin), row(basis.up / half.y, origin),
                              row(-basis.forward / range, origin, 1), dvec4(0, 0, 0, 1)});
  face.origin = glm::vec4(glm::vec3(origin), static_cast<float>(index));
  face.right = glm::vec4(glm::vec3(basis.right * half.x), static_cast<float>(range));
  face.up = glm::vec4(glm::vec3(basis.up * half.y), 0);
  face.forward = glm::vec4(glm::vec3(basis.forward), light.position.w);
  return face;
}

}  // namespace

std::vector<LightFace> light_faces(std::span<const Light> lights, const SceneFacts& facts) {
  static const std::array<Basis, 6> cube = {looking_along({1, 0, 0}, {0, 1, 0}), looking_along({-1, 0, 0}, {0, 1, 0}),
                                            looking_along({0, 1, 0}, {0, 0, 1}), looking_along({0, -1, 0}, {0, 0, 1}),
                                            looking_along({0, 0, 1}, {0, 1, 0}), looking_along({0, 0, -1}, {0, 1, 0})};
  // Nothing nearer to the light than this is seen by it. Reversed depth costs no precision for it.
  const double near = std::max(1e-5 * glm::length(facts.bounds_max - facts.bounds_min), 1e-30);
  std::vector<LightFace> faces;
  for (int i = 0; i < static_cast<int>(lights.size()); ++i) {
    const Light& light = lights[static_cast<std::size_t>(i)];
    if (static_cast<int>(light.position.w) == LIGHT_DIRECTIONAL) {
      faces.push_back(directional_face(light, i, facts));
    } else if (static_cast<int>(light.intensity.w) == 6) {
      for (const Basis& basis : cube) faces.push_back(perspective_face(light, i, basis, 1, near));
    } else {
      const double tangent = std::tan(std::max(static_cast<double>(light.cone.z), 1e-4));
      faces.push_back(perspective_face(light, i, looking_along(dvec3(light.direction)), tangent, near));
    }
  }
  return faces;
}

}  // namespace rsm
