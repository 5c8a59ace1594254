#pragma once
// Mending triangle meshes: what a file leaves out is made, what cannot be drawn is taken away.
#include <cstddef>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

struct Repairs {
  std::size_t non_finite = 0;   ///< triangles dropped for a vertex that is NaN or infinite
  std::size_t zero_area = 0;    ///< triangles dropped for having no area
  std::size_t bad_normals = 0;  ///< normals replaced by those of the faces
};

/// Drops triangles that cannot be drawn and vertices that nothing refers to, makes flat normals where there are none
/// (its vertices are then unshared), replaces normals of no length. Indices must be in range. Where `keep_degenerate`,
/// zero-area triangles stay (a skin may open them).
LOOM_API Repairs repair(Primitive& primitive, bool keep_degenerate = false);

/// Unit tangents of the texture coordinates `uvs` (as long as positions), orthogonal to the normals; w is the sign of
/// the bitangent. The sums over the triangles of a vertex are weighted by area.
LOOM_API void make_tangents(Primitive& primitive, const std::vector<glm::vec2>& uvs);

}  // namespace loom::scene
