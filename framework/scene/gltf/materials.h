#pragma once
// Materials of a glTF file.
#include <array>
#include <string>
#include <vector>

#include "scene/gltf/document.h"
#include "scene/gltf/images.h"
#include "scene/scene.h"

namespace loom::scene::gltf {

struct LoadedMaterial {
  Material material;
  /// TEXCOORD_<n> that Primitive::uv0 and uv1 are read from; −1 = none is needed.
  std::array<int, 2> uv_sets{-1, -1};
  std::string pointer;
};

/// All materials of the file; their images are asked for at `images`.
std::vector<LoadedMaterial> read_materials(Document& document, Images& images);
/// For primitives that name none. glTF's default has metallic 1 and would be black where only diffuse light is
/// computed.
Material neutral_material();
/// Takes textures away whose image could not be read.
void drop_failed_images(Material& material, const Images& images);

}  // namespace loom::scene::gltf
