#pragma once
// A 64-bit hash of what a scene holds: equal scenes, equal hashes, on every machine.
#include <cstdint>

#include "loom/export.h"
#include "scene/scene.h"

namespace loom::scene {

/// Over images, materials, geometry, nodes, animations, lights, cameras and sky. Not the path and not the names.
LOOM_API std::uint64_t content_hash(const Scene& scene);

}  // namespace loom::scene
