#pragma once
// A volume or a field of probes as bodies at their place in the scene: cells as cubes or lobes, probes as spheres.
// Plain geometry; no OpenGL.
#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/grid.h"
#include "interop/probes.h"
#include "viewer/texture_view.h"

namespace loom::viewer {

/// What a texel means where it stands.
enum class CellContent {
  value,         ///< a colour: a cube of it
  harmonics,     ///< four coefficients of spherical harmonics: a lobe, its radius the function
  coefficients,  ///< of a probe: a sphere, each point coloured by the radiance that arrives from there
  moments,       ///< of a probe: a sphere, each point coloured by the distance seen there
  state,         ///< of a probe: a cube, white where it is on
};

struct VolumeSource {
  Texels texels;  ///< a whole level
  std::variant<interop::Grid, interop::ProbeGrid> grid;
  CellContent content = CellContent::value;
  bool at_corner = false;         ///< cells stand at their lower corner, not at their centre
  bool gaussians = false;         ///< `coefficients` are of spherical Gaussians
  std::vector<glm::vec4> states;  ///< of probes: offset and whether on; empty: none
  glm::vec3 tint{1};              ///< of lobes
};

struct VolumeSettings {
  bool on = false;
  int part = 0;            ///< cascade, slab of an axis or side of a sheet
  float size = .8F;        ///< of a body, in cells or probe spacings
  bool one_slice = false;  ///< only the slice that the texture view shows
  bool operator==(const VolumeSettings&) const = default;
};

struct CellVertex {
  glm::vec3 position{0};  ///< world, metres
  std::uint32_t rgba = 0;
};

/// A body that was drawn: what a pointer may hit.
struct CellBody {
  glm::ivec3 cell{0};
  glm::vec3 centre{0};
  float radius = 0;
  glm::vec4 value{0};  ///< texel, or the first coefficient of a probe
};

struct CellMesh {
  std::vector<CellVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<CellBody> bodies;
  std::size_t cells = 0;  ///< that hold anything; fewer are drawn where there are too many
  int every = 1;          ///< along each axis, one cell in so many is drawn
};

/// More bodies than these are thinned out: nobody could tell them apart, and a software renderer has to draw them.
inline constexpr std::size_t most_bodies = 4096;

/// How many parts the texture has: cascades, slabs or sides, one behind the other along z.
int part_count(const VolumeSource& source);
/// `view`: how values become colours, and which slice `one_slice` means.
CellMesh make_cells(const VolumeSource& source, const VolumeSettings& settings, const TextureViewSettings& view);
/// The nearest body that a ray meets, −1: none.
int hit_body(const CellMesh& mesh, const glm::vec3& origin, const glm::vec3& direction);

/// Y_lm of a unit direction at l² + l + m: real, orthonormal, without the Condon–Shortley phase.
double spherical_harmonic(int index, const glm::dvec3& direction);

}  // namespace loom::viewer
