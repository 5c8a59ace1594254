#pragma once
// Bounding volume hierarchy over all triangles of the scene, for ray queries in shaders (shaders/lib/trace.glsl).
#include <vector>

#include "interop/scene.h"
#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

struct Bvh {
  std::vector<interop::BvhNode> nodes;          ///< the root first; siblings adjacent
  std::vector<interop::BvhTriangle> triangles;  ///< in the order of the leaves
  int depth = 0;                                ///< nodes on the longest path from the root, at most BVH_STACK
};

/// Triangles without area or with corners that are not finite are left out. Nodes are empty where none remain.
LOOM_API Bvh build_bvh(const Scene& scene);

}  // namespace loom::scene
