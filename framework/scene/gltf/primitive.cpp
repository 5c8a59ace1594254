#include "scene/gltf/primitive.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "scene/gltf/accessor.h"

namespace loom::scene::gltf {
namespace {

constexpr int mode_triangles = 4;
constexpr int mode_strip = 5;
constexpr int mode_fan = 6;

/// The attributes of one primitive, wherever they come from.
class Attributes {
 public:
  Attributes(Document& document, const Value& primitive)
      : document_(document), names_(primitive.require("attributes")), primitive_(primitive) {
    if (const std::optional<Value> packed = primitive.extension("KHR_draco_mesh_compression")) {
      draco_ = decode_draco(document, primitive, *packed);
    } else if (has("POSITION")) {
      document.check_count(position());
    }
  }

  [[nodiscard]] bool has(const std::string& name) const { return names_.has(name); }
  [[nodiscard]] const std::optional<DracoMesh>& draco() const { return draco_; }

  [[nodiscard]] std::size_t vertices() const { return position().count; }

  /// From here on read() returns the vertices that `indices` refer to, which become indices into those: several
  /// primitives may share one large set of vertices.
  void keep_used(std::vector<std::uint32_t>& indices) {
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(vertices(), unused);
    for (const std::uint32_t i : indices) place[i] = 0;
    used_.clear();
    for (std::uint32_t i = 0; i < place.size(); ++i) {
      if (place[i] == unused) continue;
      place[i] = static_cast<std::uint32_t>(used_.size());
      used_.push_back(i);
    }
    selective_ = used_.size() < place.size();
    for (std::uint32_t& i : indices) i = place[i];
  }

  /// Vectors of T of the vertices that are used, widened with `fill` where the file has one component less; empty where
  /// it has no such attribute.
  template <class T>
  std::vector<T> read(const std::string& name, float fill = 0) {
    const std::optional<Value> value = names_.find(name);
    if (!value) return {};
    const int index = value->as_index(document_.accessors().size(), "accessors");
    const Accessor& accessor = document_.accessors()[static_cast<std::size_t>(index)];
    const bool widened = T::length() == 4 && name.starts_with("COLOR_") && accessor.components == 3;
    const int components = widened ? 3 : T::length();
    if (accessor.components != components) {
      value->fail("gltf-type", accessor.pointer + " has " + std::to_string(accessor.components) + " components, but " +
                                   name + " needs " + std::to_string(components));
    }
    if (accessor.count != vertices()) {
      value->fail("gltf-index", "has " + std::to_string(accessor.count) + " elements, but POSITION has " +
                                    std::to_string(vertices()));
    }
    const std::vector<float>* packed = from_draco(name);
    std::vector<float> plain;
    if (packed == nullptr) plain = read_floats(document_, index, value->pointer(), selective_ ? &used_ : nullptr);
    std::vector<T> result(selective_ ? used_.size() : accessor.count);
    for (std::size_t i = 0; i < result.size(); ++i) {
      // Draco's values are all there; plain ones were selected on reading.
      const std::size_t from = packed != nullptr && selective_ ? used_[i] : i;
      const float* numbers =
          (packed != nullptr ? packed : &plain)->data() + from * static_cast<std::size_t>(components);
      for (int c = 0; c < T::length(); ++c) {
        result[i][c] = static_cast<typename T::value_type>(c < components ? numbers[c] : fill);
      }
    }
    return result;
  }

  [[nodiscard]] std::vector<std::uint32_t> indices() {
    const std::size_t count = vertices();
    if (draco_) {
      if (draco_->vertices != count) primitive_.fail("gltf-compression", "its POSITION is not part of the Draco mesh");
      return draco_->indices;
    }
    const int index = primitive_.index("indices", document_.accessors().size(), "accessors");
    std::vector<std::uint32_t> list;
    if (index < 0) {
      document_.spend(count, primitive_.pointer());
      list.resize(count);
      for (std::size_t i = 0; i < count; ++i) list[i] = static_cast<std::uint32_t>(i);
      return list;
    }
    list = read_indices(document_, index, primitive_.pointer() + "/indices");
    for (const std::uint32_t i : list) {
      if (i >= count) {
        primitive_.fail("gltf-index",
                        "has the index " + std::to_string(i) + ", but " + std::to_string(count) + " vertices");
      }
    }
    return list;
  }

 private:
  [[nodiscard]] const Accessor& position() const {
    const int index = names_.required_index("POSITION", document_.accessors().size(), "accessors");
    return document_.accessors()[static_cast<std::size_t>(index)];
  }

  const std::vector<float>* from_draco(const std::string& name) const {
    if (!draco_) return nullptr;
    for (const DracoMesh::Attribute& attribute : draco_->attributes) {
      if (attribute.name == name) return &attribute.values;
    }
    return nullptr;
  }

  Document& document_;
  Value names_;
  Value primitive_;
  std::optional<DracoMesh> draco_;
  std::vector<std::uint32_t> used_;
  bool selective_ = false;
};

/// Strips and fans as lists; the order of a strip's odd triangles is turned so that all face the same way.
std::vector<std::uint32_t> as_triangles(const std::vector<std::uint32_t>& list, int mode) {
  std::vector<std::uint32_t> triangles;
  if (mode == mode_triangles) {
    triangles.assign(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(list.size() / 3 * 3));
    return triangles;
  }
  for (std::size_t i = 0; i + 2 < list.size(); ++i) {
    if (mode == mode_fan) {
      triangles.insert(triangles.end(), {list[i + 1], list[i + 2], list[0]});
    } else if (i % 2 == 0) {
      triangles.insert(triangles.end(), {list[i], list[i + 1], list[i + 2]});
    } else {
      triangles.insert(triangles.end(), {list[i], list[i + 2], list[i + 1]});
    }
  }
  return triangles;
}

/// Texture coordinates that are not finite sample nothing sensible; they become 0.
std::vector<glm::vec2> read_uvs(Attributes& attributes, int set) {
  std::vector<glm::vec2> uvs = attributes.read<glm::vec2>("TEXCOORD_" + std::to_string(set));
  for (glm::vec2& uv : uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::vec2(0);
  }
  return uvs;
}

/// Every texture of the material must find the coordinates that it reads.
void read_texture_coordinates(Attributes& attributes, const LoadedMaterial* material, Primitive& primitive,
                              MeshReport& report) {
  const auto slot = [&](int index, std::vector<glm::vec2>& uvs) {
    const int wanted = material == nullptr ? -1 : material->uv_sets[static_cast<std::size_t>(index)];
    uvs = read_uvs(attributes, wanted < 0 ? index : wanted);
    if (wanted >= 0 && uvs.empty() && uses_slot(material->material, index)) ++report.without_texcoords;
  };
  slot(0, primitive.uv0);
  slot(1, primitive.uv1);
}

void read_colors(Attributes& attributes, Primitive& primitive) {
  primitive.colors = attributes.read<glm::vec4>("COLOR_0", 1);
  for (glm::vec4& color : primitive.colors) {
    // A reflectance over 1 would make light out of nothing.
    for (int c = 0; c < 4; ++c) color[c] = std::isfinite(color[c]) ? glm::clamp(color[c], 0.0f, 1.0f) : 1.0f;
  }
}

void read_influences(Attributes& attributes, const Value& value, Primitive& primitive, MeshReport& report) {
  if (attributes.has("JOINTS_0") != attributes.has("WEIGHTS_0")) {
    value.fail("gltf-missing", "has JOINTS_0 or WEIGHTS_0, but not both");
  }
  primitive.joints = attributes.read<glm::u16vec4>("JOINTS_0");
  primitive.weights = attributes.read<glm::vec4>("WEIGHTS_0");
  for (std::size_t i = 0; i < primitive.weights.size(); ++i) {
    glm::vec4& w = primitive.weights[i];
    for (int c = 0; c < 4; ++c) w[c] = std::isfinite(w[c]) ? std::max(w[c], 0.0f) : 0.0f;
    const float sum = w.x + w.y + w.z + w.w;
    w = sum > 0 ? w / sum : glm::vec4(1, 0, 0, 0);
  }
  if (attributes.has("JOINTS_1")) ++report.extra_influences;
}

}  // namespace

bool uses_slot(const Material& material, int slot) {
  for (const TextureRef* texture : {&material.base_color_texture, &material.metallic_roughness_texture,
                                    &material.normal_texture, &material.emissive_texture}) {
    if (texture->image >= 0 && texture->uv_set == slot) return true;
  }
  return false;
}

std::optional<Primitive> read_primitive(Document& document, const Value& value,
                                        const std::vector<LoadedMaterial>& materials, bool skinned,
                                        MeshReport& report) {
  const int mode = static_cast<int>(value.integer("mode", mode_triangles, 0, mode_fan));
  if (mode < mode_triangles) {
    ++report.points_and_lines;
    return std::nullopt;
  }
  Attributes attributes(document, value);
  if (!attributes.has("POSITION")) {
    ++report.without_positions;
    return std::nullopt;
  }
  Primitive primitive;
  // Which is the file's own default material is settled by the caller.
  primitive.material = value.index("material", materials.size(), "materials");
  const LoadedMaterial* material =
      primitive.material < 0 ? nullptr : &materials[static_cast<std::size_t>(primitive.material)];
  primitive.indices = as_triangles(attributes.indices(), attributes.draco() ? mode_triangles : mode);
  attributes.keep_used(primitive.indices);
  primitive.positions = attributes.read<glm::vec3>("POSITION");
  primitive.normals = attributes.read<glm::vec3>("NORMAL");
  primitive.tangents = attributes.read<glm::vec4>("TANGENT");
  read_texture_coordinates(attributes, material, primitive, report);
  read_colors(attributes, primitive);
  if (skinned) read_influences(attributes, value, primitive, report);

  const Repairs repairs = repair(primitive, !primitive.joints.empty());
  report.repairs.non_finite += repairs.non_finite;
  report.repairs.zero_area += repairs.zero_area;
  report.repairs.bad_normals += repairs.bad_normals;
  if (primitive.indices.empty()) return std::nullopt;
  if (material == nullptr) ++report.without_material;
  if (material != nullptr && material->material.normal_texture.image >= 0 && primitive.tangents.empty()) {
    const TextureRef& map = material->material.normal_texture;
    std::vector<glm::vec2> uvs = map.uv_set == 0 ? primitive.uv0 : primitive.uv1;
    // The map is read through its transform, so its axes are those of the transformed coordinates.
    for (glm::vec2& uv : uvs) uv = map.transform * glm::vec3(uv, 1);
    if (!uvs.empty()) make_tangents(primitive, uvs);
  }
  return primitive;
}

}  // namespace loom::scene::gltf
