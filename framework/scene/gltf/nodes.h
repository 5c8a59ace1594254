#pragma once
// The node tree of a glTF file with what hangs on it: meshes, skins, lights, cameras, animations.
#include <vector>

#include "scene/gltf/document.h"
#include "scene/scene.h"

namespace loom::scene::gltf {

/// Which node carries what; parallel to Scene::nodes. Indices are the file's.
struct NodeUse {
  int mesh = -1, skin = -1, camera = -1, light = -1;
  bool shown = false;  ///< in the scene that is drawn, and not hidden
  std::string pointer;
};

struct NodeTree {
  std::vector<Node> nodes;  ///< parents before children; mesh, skin, camera and light still unset
  std::vector<NodeUse> uses;
  std::vector<int> place;  ///< index in the file → index in `nodes`
};

/// Throws BadInput where a node has two parents or is its own ancestor.
NodeTree read_nodes(Document& document);
std::vector<Skin> read_skins(Document& document, const NodeTree& tree);
std::vector<Animation> read_animations(Document& document, const NodeTree& tree);
/// KHR_lights_punctual; position and direction are set by pose().
std::vector<Light> read_lights(Document& document);
std::vector<Camera> read_cameras(Document& document);

}  // namespace loom::scene::gltf
