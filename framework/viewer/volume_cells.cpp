#include "viewer/volume_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace loom::viewer {
namespace {

struct Sphere {
  std::vector<glm::vec3> points;  ///< unit
  std::vector<std::uint32_t> indices;
};

/// An icosahedron with each triangle in four: 42 points.
Sphere make_sphere() {
  const float phi = std::numbers::phi_v<float>;
  Sphere sphere;
  for (const float a : {-1.F, 1.F})
    for (const float b : {-phi, phi})
      for (const glm::vec3 p : {glm::vec3(0, a, b), glm::vec3(a, b, 0), glm::vec3(b, 0, a)})
        sphere.points.push_back(glm::normalize(p));
  const float edge = 1.06F;  // corners of a unit icosahedron are 1.05 apart
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(sphere.points.size()));
    if (fresh) sphere.points.push_back(glm::normalize(sphere.points[a] + sphere.points[b]));
    return at->second;
  };
  const auto near = [&](std::uint32_t a, std::uint32_t b) {
    return glm::distance(sphere.points[a], sphere.points[b]) < edge;
  };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        if (!near(a, b) || !near(b, c) || !near(a, c)) continue;
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const std::uint32_t i : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) sphere.indices.push_back(i);
      }
  return sphere;
}

const Sphere& sphere() {
  static const Sphere made = make_sphere();
  return made;
}

/// Brightness of a face by where it looks, as if lit from above and a little from the side: bodies need edges.
float shade(const glm::vec3& normal) { return .8F + .15F * normal.y + .05F * normal.x; }

std::uint32_t shaded(std::uint32_t rgba, float by) {
  std::uint32_t result = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    result |= static_cast<std::uint32_t>(std::clamp(static_cast<float>(rgba >> (8 * c) & 255u) * by, 0.F, 255.F))
              << (8 * c);
  return result;
}

void add_cube(CellMesh& mesh, const glm::vec3& centre, float half, std::uint32_t rgba) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.F, 1.F}) {
      glm::vec3 normal(0);
      normal[axis] = side;
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (int corner = 0; corner < 4; ++corner) {
        glm::vec3 at = normal;
        at[(axis + 1) % 3] = (corner & 1) != 0 ? 1.F : -1.F;
        at[(axis + 2) % 3] = (corner & 2) != 0 ? 1.F : -1.F;
        mesh.vertices.push_back({centre + half * at, shaded(rgba, shade(normal))});
      }
      for (const std::uint32_t i : {0u, 1u, 2u, 2u, 1u, 3u}) mesh.indices.push_back(first + i);
    }
}

/// A star-shaped body: radius and colour of each point of the sphere.
void add_body(CellMesh& mesh, const glm::vec3& centre, const auto& radius, const auto& colour) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::size_t i = 0; i < sphere().points.size(); ++i)
    mesh.vertices.push_back({centre + radius(i) * sphere().points[i], colour(i)});
  for (const std::uint32_t i : sphere().indices) mesh.indices.push_back(first + i);
}

glm::ivec3 cell_counts(const VolumeSource& source) {
  const auto* probes = std::get_if<interop::ProbeGrid>(&source.grid);
  const glm::ivec3 counts = probes != nullptr ? probes->counts : std::get<interop::Grid>(source.grid).cells;
  // What the texture has not, no struct can make.
  const glm::ivec3 size = source.texels.box.size;
  if (source.content == CellContent::coefficients)
    return glm::clamp(counts, glm::ivec3(0),
                      glm::ivec3(size.x / std::max(probes != nullptr ? probes->counts.w : 1, 1), size.y, size.z));
  if (source.content == CellContent::moments) {
    const int side = std::max(probes != nullptr ? static_cast<int>(probes->weights.x) : 1, 1);
    return glm::clamp(counts, glm::ivec3(0), glm::ivec3(size.x / side, size.y / side, size.z));
  }
  return glm::clamp(counts, glm::ivec3(0), size);
}

const glm::vec4& texel(const Texels& texels, const glm::ivec3& p) {
  const glm::ivec3 size = texels.box.size;
  return texels
      .values[(static_cast<std::size_t>(p.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(p.y)) *
                  static_cast<std::size_t>(size.x) +
              static_cast<std::size_t>(p.x)];
}

/// The texels that belong to one cell.
struct CellTexels {
  const VolumeSource& source;
  glm::ivec3 cell{0};
  int part = 0;

  [[nodiscard]] int count() const {
    const auto* probes = std::get_if<interop::ProbeGrid>(&source.grid);
    if (probes == nullptr) return 1;
    if (source.content == CellContent::coefficients) return std::max(probes->counts.w, 1);
    if (source.content == CellContent::moments) return std::max(side() * side(), 1);
    return 1;
  }
  [[nodiscard]] int side() const { return static_cast<int>(std::get<interop::ProbeGrid>(source.grid).weights.x); }
  [[nodiscard]] const glm::vec4& operator[](int i) const {
    if (source.content == CellContent::coefficients)
      return texel(source.texels, {cell.x * count() + i, cell.y, cell.z});
    if (source.content == CellContent::moments)
      return texel(source.texels, {cell.x * side() + i % side(), cell.y * side() + i / side(), cell.z});
    return texel(source.texels, {cell.x, cell.y, cell.z + part * cell_counts(source).z});
  }
  [[nodiscard]] bool empty() const {
    for (int i = 0; i < count(); ++i)
      if ((*this)[i] != glm::vec4(0)) return false;  // a NaN is no zero
    return true;
  }
};

glm::vec2 octahedral(const glm::vec3& w) {
  const glm::vec2 p = glm::vec2(w) / (std::abs(w.x) + std::abs(w.y) + std::abs(w.z));
  const glm::vec2 side(p.x >= 0 ? 1 : -1, p.y >= 0 ? 1 : -1);
  return w.z >= 0 ? p : (1.F - glm::abs(glm::vec2(p.y, p.x))) * side;
}

/// λ = 3 about the corners of an icosahedron, as shaders/lib/spherical_gaussians.glsl has them.
double spherical_gaussian(int i, const glm::dvec3& direction) {
  glm::dvec3 axis(0);
  axis[(i / 4 + 1) % 3] = (i & 1) == 0 ? .525731112 : -.525731112;
  axis[(i / 4 + 2) % 3] = (i & 2) == 0 ? .850650808 : -.850650808;
  return std::exp(3 * (glm::dot(direction, axis) - 1));
}

/// Value of each basis function at each point of the sphere.
std::vector<std::vector<float>> basis_table(int count, bool gaussians) {
  std::vector<std::vector<float>> table;
  for (const glm::vec3& point : sphere().points) {
    std::vector<float>& row = table.emplace_back();
    for (int i = 0; i < count; ++i)
      row.push_back(static_cast<float>(gaussians ? spherical_gaussian(i, point) : spherical_harmonic(i, point)));
  }
  return table;
}

struct Place {
  glm::vec3 centre{0};
  float size = 1;  ///< of a cell, metres
};

Place place_of_cell(const VolumeSource& source, const glm::ivec3& cell, int part) {
  if (const auto* probes = std::get_if<interop::ProbeGrid>(&source.grid)) {
    glm::vec3 centre = glm::vec3(probes->lower) + glm::vec3(cell) * glm::vec3(probes->spacing);
    const std::size_t index = (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(probes->counts.y) +
                               static_cast<std::size_t>(cell.y)) *
                                  static_cast<std::size_t>(probes->counts.x) +
                              static_cast<std::size_t>(cell.x);
    if (index < source.states.size()) centre += glm::vec3(source.states[index]);
    return {centre, .5F * std::min({probes->spacing.x, probes->spacing.y, probes->spacing.z})};
  }
  const auto& grid = std::get<interop::Grid>(source.grid);
  const glm::vec4 cascade = grid.cascade[std::clamp(part, 0, std::clamp(grid.cells.w, 1, LOOM_MAX_CASCADES) - 1)];
  return {glm::vec3(cascade) + (glm::vec3(cell) + (source.at_corner ? 0.F : .5F)) * cascade.w, cascade.w};
}

/// The cells to draw.
std::vector<glm::ivec3> chosen_cells(const VolumeSource& source, const VolumeSettings& settings,
                                     const TextureViewSettings& view, int part, CellMesh& mesh) {
  const glm::ivec3 counts = cell_counts(source);
  const bool grid = std::holds_alternative<interop::Grid>(source.grid);
  const int slice = grid && view.axis == 2 ? view.slice - part * counts.z : view.slice;
  const int axis = grid ? view.axis : 2;
  std::vector<glm::ivec3> filled;
  for (int z = 0; z < counts.z; ++z)
    for (int y = 0; y < counts.y; ++y)
      for (int x = 0; x < counts.x; ++x) {
        const glm::ivec3 cell(x, y, z);
        if (settings.one_slice && cell[axis] != slice) continue;
        if (!CellTexels{source, cell, part}.empty()) filled.push_back(cell);
      }
  mesh.cells = filled.size();
  std::vector<glm::ivec3> chosen = filled;
  for (mesh.every = 1; chosen.size() > most_bodies;) {
    ++mesh.every;
    chosen.clear();
    for (const glm::ivec3& cell : filled) {
      bool in = true;
      for (int c = 0; c < 3; ++c)
        in = in && ((settings.one_slice && c == axis) || cell[c] % mesh.every == mesh.every / 2);
      if (in) chosen.push_back(cell);
    }
  }
  return chosen;
}

bool finite(float v) { return std::isfinite(v); }

/// Lobes: polar plots of their functions, the largest of all filling its cell. Where one is negative: magenta.
void add_lobes(CellMesh& mesh, const VolumeSource& source, float share, int part) {
  const auto basis = basis_table(4, false);
  const auto value = [&](const glm::vec4& c, std::size_t i) {
    return c.x * basis[i][0] + c.y * basis[i][1] + c.z * basis[i][2] + c.w * basis[i][3];
  };
  std::vector<float> peaks;
  for (const CellBody& body : mesh.bodies) {
    float peak = 0;
    for (std::size_t i = 0; i < basis.size(); ++i)
      if (const float v = value(body.value, i); finite(v)) peak = std::max(peak, std::abs(v));
    peaks.push_back(peak);
  }
  // The largest one percent would hide all others: they are cut off at their neighbours' size.
  std::vector<float> sorted = peaks;
  const float top = std::max(percentile_range(sorted, {0, 99}).y, 1e-30F);
  const std::uint32_t magenta = 0xffff00ffu;
  for (CellBody& body : mesh.bodies) {
    const float size = place_of_cell(source, body.cell, part).size * share * static_cast<float>(mesh.every) * .5F;
    // Light falls over orders of magnitude: a lobe is as long as the root of its peak, so that weak ones are seen.
    const float peak = std::max(peaks[static_cast<std::size_t>(&body - mesh.bodies.data())], 1e-30F);
    const float length = size * std::sqrt(std::min(peak / top, 1.F));
    const auto radius = [&](std::size_t i) {
      const float v = value(body.value, i);
      return finite(v) ? length * std::clamp(std::abs(v) / peak, .02F, 1.F) : size;
    };
    const auto colour = [&](std::size_t i) {
      const float v = value(body.value, i);
      if (!finite(v) || v < 0) return magenta;
      const glm::vec3 rgb = source.tint * (.35F + .65F * std::sqrt(std::min(v / top, 1.F)));
      return shaded(colour_of(rgb, {.encode = false}, {0, 1}), shade(sphere().points[i]));
    };
    body.radius = length;
    add_body(mesh, body.centre, radius, colour);
  }
}

/// Spheres whose points show what the probe has in that direction.
void add_probes(CellMesh& mesh, const VolumeSource& source, const TextureViewSettings& view) {
  const int count = CellTexels{source}.count();
  const bool moments = source.content == CellContent::moments;
  const auto basis = moments ? std::vector<std::vector<float>>() : basis_table(count, source.gaussians);
  std::vector<glm::vec3> seen;  // of all points of all probes
  for (const CellBody& body : mesh.bodies) {
    const CellTexels texels{source, body.cell};
    for (std::size_t i = 0; i < sphere().points.size(); ++i) {
      glm::vec3 sum(0);
      if (moments) {
        const glm::ivec2 at =
            glm::clamp(glm::ivec2((octahedral(sphere().points[i]) + 1.F) * .5F * static_cast<float>(texels.side())),
                       glm::ivec2(0), glm::ivec2(texels.side() - 1));
        sum = glm::vec3(texels[at.y * texels.side() + at.x].x);
      } else {
        for (int k = 0; k < count; ++k) sum += basis[i][static_cast<std::size_t>(k)] * glm::vec3(texels[k]);
      }
      seen.push_back(sum);
    }
  }
  glm::vec2 range(0, 1);
  if (view.percentiles || moments) {
    std::vector<float> values;
    for (const glm::vec3& v : seen)
      for (int c = 0; c < 3; ++c)
        if (finite(v[c])) values.push_back(v[c]);
    range = percentile_range(values, view.percentiles.value_or(glm::vec2(0, 99)));
  }
  std::size_t first = 0;
  for (const CellBody& body : mesh.bodies) {
    add_body(
        mesh, body.centre, [&](std::size_t) { return body.radius; },
        [&](std::size_t i) { return colour_of(seen[first + i], view, range); });
    first += sphere().points.size();
  }
}

}  // namespace

double spherical_harmonic(int index, const glm::dvec3& direction) {
  const int l = static_cast<int>(std::sqrt(static_cast<double>(index)));
  const int m = index - l * l - l, order = std::abs(m);
  const double theta = std::acos(std::clamp(direction.z, -1., 1.)), phi = std::atan2(direction.y, direction.x);
  // The library's function has the phase.
  const double zonal =
      std::sph_legendre(static_cast<unsigned>(l), static_cast<unsigned>(order), theta) * ((order & 1) != 0 ? -1 : 1);
  if (m == 0) return zonal;
  return std::numbers::sqrt2 * zonal * (m > 0 ? std::cos(order * phi) : std::sin(order * phi));
}

int part_count(const VolumeSource& source) {
  const int deep = cell_counts(source).z;
  const bool grid = std::holds_alternative<interop::Grid>(source.grid);
  return grid && deep > 0 ? std::max(source.texels.box.size.z / deep, 1) : 1;
}

CellMesh make_cells(const VolumeSource& source, const VolumeSettings& settings, const TextureViewSettings& view) {
  CellMesh mesh;
  const int part = std::clamp(settings.part, 0, part_count(source) - 1);
  const bool probes = std::holds_alternative<interop::ProbeGrid>(source.grid);
  for (const glm::ivec3& cell : chosen_cells(source, settings, view, part, mesh)) {
    const Place place = place_of_cell(source, cell, part);
    const float size = place.size * settings.size * (probes ? 1.F : static_cast<float>(mesh.every));
    mesh.bodies.push_back({cell, place.centre, .5F * size, CellTexels{source, cell, part}[0]});
  }
  switch (source.content) {
    case CellContent::harmonics:
      add_lobes(mesh, source, settings.size, part);
      return mesh;
    case CellContent::coefficients:
    case CellContent::moments:
      add_probes(mesh, source, view);
      return mesh;
    case CellContent::state:
      for (const CellBody& body : mesh.bodies)
        add_cube(mesh, body.centre, body.radius, body.value.w > .5F ? 0xffffffffu : 0xff404040u);
      return mesh;
    case CellContent::value:
      break;
  }
  const auto shown = [&](const CellBody& body) { return shown_channels(body.value, view.channels, 4); };
  glm::vec2 range(0, 1);
  if (view.percentiles) {
    std::vector<float> values;
    for (const CellBody& body : mesh.bodies)
      for (int c = 0; c < 3; ++c)
        if (finite(shown(body)[c])) values.push_back(shown(body)[c]);
    range = percentile_range(values, *view.percentiles);
  }
  for (const CellBody& body : mesh.bodies)
    add_cube(mesh, body.centre, body.radius, colour_of(shown(body), view, range));
  return mesh;
}

int hit_body(const CellMesh& mesh, const glm::vec3& origin, const glm::vec3& direction) {
  int nearest = -1;
  float at = std::numeric_limits<float>::max();
  const glm::vec3 way = glm::normalize(direction);
  for (std::size_t i = 0; i < mesh.bodies.size(); ++i) {
    const CellBody& body = mesh.bodies[i];
    const float along = glm::dot(body.centre - origin, way);
    if (along <= 0 || along >= at) continue;
    if (glm::distance(origin + along * way, body.centre) > body.radius) continue;
    at = along;
    nearest = static_cast<int>(i);
  }
  return nearest;
}

}  // namespace loom::viewer
