#pragma once
// What the scene's animation can move, and how far.
#include <vector>

#include "loom/export.h"
#include "scene/bounds.h"
#include "scene/scene.h"

namespace loom::scene {

/// True where some channel of the first animation moves nodes, lights or cameras.
LOOM_API bool is_animated(const Scene& scene);

/// One an instance: true where a channel of the first animation moves its node, a node above that, or a joint of its
/// skin.
LOOM_API std::vector<bool> moving_instances(const Scene& scene);

/// The box of all that is drawn, over the whole animation: every pose at a key and at four steps between each two, at
/// most 128 of them, evenly spread where there are more.
LOOM_API Box swept_box(const Scene& scene);

}  // namespace loom::scene
