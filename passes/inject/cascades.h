#pragma once
// Where the nested grids of Inject lie.
#include "interop/camera.h"
#include "interop/grid.h"

namespace inject {

/// `count` nested grids of the same number of cells, finest first: the last is `coarsest`, each other one has half the
/// cell of the next. They lie a quarter of their side ahead of the camera, or as near to that as the coarsest reaches,
/// and move by whole cells of their own, so that the faces of all cells stay where they are in the world.
loom::interop::Grid place_cascades(const loom::interop::Grid& coarsest, int count, const loom::interop::Camera& camera);

}  // namespace inject
