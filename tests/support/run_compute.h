#pragma once
// Runs a compute program outside of any graph: blocks by name, from the scene or handed in.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "loom/gpu.h"
#include "loom/scene_view.h"

namespace loom::test {

using Blocks = std::map<std::string, const Buffer*>;

/// Binds `blocks` (storage and uniform), the scene's buffers and textures, and dispatches `groups` work groups.
void run_compute(const Program& program, const SceneView& scene, const Blocks& blocks, unsigned int groups);

}  // namespace loom::test
