// KHR_draco_mesh_compression.
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>

#include <exception>
#include <memory>

#include "scene/gltf/primitive.h"

namespace loom::scene::gltf {
namespace {

std::unique_ptr<draco::Mesh> decode(Bytes bytes, std::string& why) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  try {
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (mesh.ok()) return std::move(mesh).value();
    why = mesh.status().error_msg_string();
  } catch (const std::exception& error) {
    // Damaged streams end here too, when they ask for more memory than there is.
    why = error.what();
  }
  return nullptr;
}

/// What 1 is stored as in a normalised integer.
float largest(int component_type) {
  switch (component_type) {
    case 5120:
      return 127;
    case 5121:
      return 255;
    case 5122:
      return 32767;
    default:
      return 65535;
  }
}

}  // namespace

DracoMesh decode_draco(Document& document, const Value& primitive, const Value& extension) {
  const int view = extension.required_index("bufferView", document.view_count(), "bufferViews");
  std::string why;
  const std::unique_ptr<draco::Mesh> mesh = decode(document.view(view, extension.pointer()), why);
  if (!mesh) extension.fail("gltf-compression", "is no valid Draco mesh: " + why);

  DracoMesh result;
  result.vertices = mesh->num_points();
  document.spend(result.vertices + std::size_t{mesh->num_faces()} * 3, extension.pointer());
  const Value names = primitive.require("attributes");
  for (const auto& [name, id] : extension.require("attributes").members()) {
    const int accessor_index = names.index(name, document.accessors().size(), "accessors");
    if (accessor_index < 0) id.fail("gltf-compression", "is compressed, but no attribute of the primitive");
    const draco::PointAttribute* source =
        mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(id.as_index(1u << 30, "Draco attributes")));
    if (source == nullptr) id.fail("gltf-compression", "is no attribute of the Draco mesh");
    const Accessor& accessor = document.accessors()[static_cast<std::size_t>(accessor_index)];
    if (accessor.count != result.vertices || accessor.components != source->num_components()) {
      id.fail("gltf-compression", "has " + std::to_string(result.vertices) + " × " +
                                      std::to_string(source->num_components()) + " values, but " + accessor.pointer +
                                      " says " + std::to_string(accessor.count) + " × " +
                                      std::to_string(accessor.components));
    }
    DracoMesh::Attribute attribute{name, accessor.components, {}};
    const auto components = static_cast<std::size_t>(accessor.components);
    attribute.values.resize(result.vertices * components);
    if (!source->is_mapping_identity() && source->indices_map_size() < result.vertices) {
      id.fail("gltf-compression", "has no value for some vertices");
    }
    // ConvertValue() normalises by the flag of the stream; the accessor's is the one that counts.
    const float scale = accessor.normalized && !source->normalized() ? 1 / largest(accessor.component_type) : 1;
    for (draco::PointIndex point(0); point < mesh->num_points(); ++point) {
      float* out = &attribute.values[point.value() * components];
      if (!source->ConvertValue<float>(source->mapped_index(point), static_cast<std::int8_t>(components), out)) {
        id.fail("gltf-compression", "cannot be converted to numbers");
      }
      for (std::size_t c = 0; c < components; ++c) out[c] *= scale;
    }
    result.attributes.push_back(std::move(attribute));
  }
  result.indices.reserve(std::size_t{mesh->num_faces()} * 3);
  for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t corner = mesh->face(face)[static_cast<std::size_t>(c)].value();
      if (corner >= result.vertices) extension.fail("gltf-compression", "has a face that refers to no vertex");
      result.indices.push_back(corner);
    }
  }
  return result;
}

}  // namespace loom::scene::gltf
