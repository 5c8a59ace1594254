#include "scene/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace loom::scene {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Twice the area times the face normal, in double so that small triangles far out keep their direction.
glm::dvec3 area_normal(const Primitive& p, const std::uint32_t* corner) {
  const glm::dvec3 a(p.positions[corner[0]]);
  return glm::cross(glm::dvec3(p.positions[corner[1]]) - a, glm::dvec3(p.positions[corner[2]]) - a);
}

template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(from.size());
  for (const std::uint32_t i : from) result.push_back(values[i]);
  values = std::move(result);
}

/// Vertex i becomes old vertex from[i].
void gather_vertices(Primitive& p, const std::vector<std::uint32_t>& from) {
  gather(p.positions, from);
  gather(p.normals, from);
  gather(p.uv0, from);
  gather(p.uv1, from);
  gather(p.colors, from);
  gather(p.tangents, from);
  gather(p.joints, from);
  gather(p.weights, from);
}

void drop_triangles(Primitive& p, bool keep_degenerate, Repairs& repairs) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
    const std::uint32_t* corner = &p.indices[i];
    if (!finite(p.positions[corner[0]]) || !finite(p.positions[corner[1]]) || !finite(p.positions[corner[2]])) {
      ++repairs.non_finite;
      continue;
    }
    if (!keep_degenerate && area_normal(p, corner) == glm::dvec3(0)) {
      ++repairs.zero_area;
      continue;
    }
    std::copy_n(corner, 3, &p.indices[kept]);
    kept += 3;
  }
  p.indices.resize(kept);
}

void drop_unused_vertices(Primitive& p) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(p.positions.size(), unused);
  std::vector<std::uint32_t> from;
  for (const std::uint32_t i : p.indices) place[i] = 0;
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    if (place[i] == unused) continue;
    place[i] = static_cast<std::uint32_t>(from.size());
    from.push_back(i);
  }
  if (from.size() == p.positions.size()) return;
  for (std::uint32_t& i : p.indices) i = place[i];
  gather_vertices(p, from);
}

void make_flat_normals(Primitive& p) {
  gather_vertices(p, std::vector<std::uint32_t>(p.indices));
  p.normals.resize(p.indices.size());
  for (std::uint32_t i = 0; i < p.indices.size(); ++i) p.indices[i] = i;
  for (std::size_t i = 0; i < p.indices.size(); i += 3) {
    const glm::dvec3 normal = area_normal(p, &p.indices[i]);
    const double length = glm::length(normal);
    const glm::vec3 unit = length > 0 ? glm::vec3(normal / length) : glm::vec3(0, 1, 0);
    std::fill_n(p.normals.begin() + static_cast<std::ptrdiff_t>(i), 3, unit);
  }
}

void mend_normals(Primitive& p, Repairs& repairs) {
  std::vector<glm::dvec3> sums;
  for (std::size_t i = 0; i < p.normals.size(); ++i) {
    const glm::dvec3 normal(p.normals[i]);
    const double length = glm::length(normal);
    if (std::isfinite(length) && length > 0) {
      p.normals[i] = glm::vec3(normal / length);
      continue;
    }
    if (sums.empty()) {
      sums.assign(p.positions.size(), glm::dvec3(0));
      for (std::size_t t = 0; t < p.indices.size(); t += 3) {
        const glm::dvec3 face = area_normal(p, &p.indices[t]);
        for (std::size_t c = 0; c < 3; ++c) sums[p.indices[t + c]] += face;
      }
    }
    const double sum = glm::length(sums[i]);
    p.normals[i] = sum > 0 ? glm::vec3(sums[i] / sum) : glm::vec3(0, 1, 0);
    ++repairs.bad_normals;
  }
}

glm::dvec3 any_orthogonal(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(n, axis));
}

}  // namespace

Repairs repair(Primitive& primitive, bool keep_degenerate) {
  Repairs repairs;
  drop_triangles(primitive, keep_degenerate, repairs);
  drop_unused_vertices(primitive);
  if (primitive.normals.empty()) {
    primitive.tangents.clear();  // glTF: tangents without normals have no meaning
    make_flat_normals(primitive);
  } else {
    mend_normals(primitive, repairs);
  }
  return repairs;
}

void make_tangents(Primitive& p, const std::vector<glm::vec2>& uvs) {
  std::vector<glm::dvec3> along_u(p.positions.size(), glm::dvec3(0));
  std::vector<glm::dvec3> along_v(p.positions.size(), glm::dvec3(0));
  for (std::size_t t = 0; t + 2 < p.indices.size(); t += 3) {
    const std::uint32_t* i = &p.indices[t];
    const glm::dvec3 e1 = glm::dvec3(p.positions[i[1]]) - glm::dvec3(p.positions[i[0]]);
    const glm::dvec3 e2 = glm::dvec3(p.positions[i[2]]) - glm::dvec3(p.positions[i[0]]);
    const glm::dvec2 d1 = glm::dvec2(uvs[i[1]]) - glm::dvec2(uvs[i[0]]);
    const glm::dvec2 d2 = glm::dvec2(uvs[i[2]]) - glm::dvec2(uvs[i[0]]);
    const double determinant = d1.x * d2.y - d2.x * d1.y;
    if (determinant == 0 || !std::isfinite(determinant)) continue;
    const double weight = glm::length(glm::cross(e1, e2));
    const glm::dvec3 u = (e1 * d2.y - e2 * d1.y) * (determinant > 0 ? 1.0 : -1.0);
    const glm::dvec3 v = (e2 * d1.x - e1 * d2.x) * (determinant > 0 ? 1.0 : -1.0);
    const double u_length = glm::length(u);
    const double v_length = glm::length(v);
    if (!(u_length > 0) || !(v_length > 0)) continue;
    for (int c = 0; c < 3; ++c) {
      along_u[i[c]] += u * (weight / u_length);
      along_v[i[c]] += v * (weight / v_length);
    }
  }
  p.tangents.resize(p.positions.size());
  for (std::size_t i = 0; i < p.positions.size(); ++i) {
    const glm::dvec3 n(p.normals[i]);
    const glm::dvec3 flat = along_u[i] - n * glm::dot(n, along_u[i]);
    const double length = glm::length(flat);
    const glm::dvec3 tangent = length > 0 ? flat / length : any_orthogonal(n);
    // glTF: bitangent = w · (n × t) is the image's up, where v falls.
    const double sign = glm::dot(glm::cross(n, tangent), along_v[i]) > 0 ? -1 : 1;
    p.tangents[i] = glm::vec4(glm::vec3(tangent), static_cast<float>(sign));
  }
}

}  // namespace loom::scene
