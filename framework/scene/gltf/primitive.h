#pragma once
// Primitives of a glTF mesh: attributes and indices, plain or Draco-compressed, as lists of triangles.
#include <optional>

#include "scene/geometry.h"
#include "scene/gltf/document.h"
#include "scene/gltf/materials.h"
#include "scene/scene.h"

namespace loom::scene::gltf {

/// What is counted over the whole file and said once at the end.
struct MeshReport {
  std::size_t points_and_lines = 0;
  std::size_t without_positions = 0;
  std::size_t without_material = 0;
  std::size_t without_texcoords = 0;
  std::size_t extra_influences = 0;
  Repairs repairs;
};

/// One primitive; empty where it has nothing to draw. `skinned`: joints and weights are wanted.
std::optional<Primitive> read_primitive(Document& document, const Value& value,
                                        const std::vector<LoadedMaterial>& materials, bool skinned, MeshReport& report);

/// True where a texture of the material reads Primitive::uv0 (slot 0) or uv1 (slot 1).
bool uses_slot(const Material& material, int slot);

/// Undoes KHR_draco_mesh_compression; the accessors of the primitive say what its attributes mean.
struct DracoMesh {
  struct Attribute {
    std::string name;
    int components = 0;
    std::vector<float> values;
  };
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;
  std::size_t vertices = 0;
};
DracoMesh decode_draco(Document& document, const Value& primitive, const Value& extension);

}  // namespace loom::scene::gltf
