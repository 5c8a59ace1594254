#pragma once
// The whole of a glTF file as a scene.
#include <string>

#include "loom/diagnostic.h"
#include "scene/scene.h"

namespace loom::scene::gltf {

/// As load_gltf(), but leaves the content hash to the caller, who may still change the scene.
Scene load(const std::string& path, Diagnostics& diagnostics, bool outside);

}  // namespace loom::scene::gltf
