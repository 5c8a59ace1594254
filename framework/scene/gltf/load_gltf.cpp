// Puts the parts of a glTF file together.
#include "scene/gltf/load_gltf.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <set>
#include <string_view>

#include "scene/content_hash.h"
#include "scene/gltf/images.h"
#include "scene/gltf/materials.h"
#include "scene/gltf/nodes.h"
#include "scene/gltf/primitive.h"
#include "scene/load.h"

namespace loom::scene {
namespace gltf {
namespace {

constexpr std::array<std::string_view, 10> understood{"EXT_meshopt_compression", "KHR_draco_mesh_compression",
                                                      "KHR_lights_punctual",     "KHR_materials_emissive_strength",
                                                      "KHR_materials_ior",       "KHR_materials_transmission",
                                                      "KHR_mesh_quantization",   "KHR_node_visibility",
                                                      "KHR_texture_transform",   "KHR_materials_pbrSpecularGlossiness"};
/// Metadata, and choices of which the file's own default is drawn.
constexpr std::array<std::string_view, 3> harmless{"KHR_materials_variants", "KHR_xmp", "KHR_xmp_json_ld"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::vector<std::string> strings(const Value& root, std::string_view key) {
  std::vector<std::string> list;
  for (const Value& value : root.items(key)) {
    if (!value.json().is_string()) value.fail("gltf-type", "must be a string");
    list.push_back(value.json().get<std::string>());
  }
  return list;
}

void check_extensions(Document& document) {
  std::string missing;
  std::set<std::string> named;
  for (const std::string& name : strings(document.root(), "extensionsRequired")) {
    named.insert(name);
    if (!contains(understood, name) && !contains(harmless, name)) missing += (missing.empty() ? "" : ", ") + name;
  }
  if (!missing.empty()) {
    document.fail("/extensionsRequired", "gltf-extension", "needs what is not supported: " + missing,
                  "export the file without it, or decode it with a glTF tool first");
  }
  for (const std::string& name : strings(document.root(), "extensionsUsed")) {
    if (contains(understood, name) || contains(harmless, name) || !named.insert(name).second) continue;
    const bool material = name.starts_with("KHR_materials_");
    document.warn("gltf-extension",
                  name + (material ? " is left out: the diffuse part of the material is drawn"
                                   : " is not supported and left out"),
                  "/extensionsUsed");
  }
}

class Loader {
 public:
  Loader(const std::string& path, Diagnostics& diagnostics, bool outside)
      : document_(path, diagnostics, outside), images_(document_) {
    scene_.path = path;
  }

  Scene load() {
    check_extensions(document_);
    const std::vector<LoadedMaterial> materials = read_materials(document_, images_);
    images_.start();
    NodeTree tree = read_nodes(document_);
    scene_.nodes = std::move(tree.nodes);
    const std::vector<Light> lights = read_lights(document_);
    const std::vector<Camera> cameras = read_cameras(document_);
    tree.nodes = scene_.nodes;
    scene_.skins = read_skins(document_, tree);
    scene_.animations = read_animations(document_, tree);
    mesh_values_ = document_.root().items("meshes");
    count_mesh_uses(tree.uses);
    for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
      const NodeUse& use = tree.uses[i];
      if (!use.shown) continue;
      place_mesh(i, use, materials);
      place_light(i, use, lights);
      place_camera(i, use, cameras);
    }
    finish_materials(materials);
    report();
    pose(scene_, 0);
    return std::move(scene_);
  }

 private:
  void count_mesh_uses(const std::vector<NodeUse>& uses) {
    read_.resize(mesh_values_.size());
    plain_.assign(mesh_values_.size(), -1);
    skinned_uses_.assign(mesh_values_.size(), false);
    for (const NodeUse& use : uses) {
      if (use.shown && use.mesh >= 0 && use.skin >= 0) skinned_uses_[static_cast<std::size_t>(use.mesh)] = true;
    }
  }

  void place_mesh(std::size_t node, const NodeUse& use, const std::vector<LoadedMaterial>& materials) {
    if (use.mesh < 0) {
      if (use.skin >= 0) document_.warn("gltf-skin", "has a skin, but no mesh", use.pointer);
      return;
    }
    const auto index = static_cast<std::size_t>(use.mesh);
    if (!read_[index]) read_[index] = read_mesh(index, materials);
    const Mesh& mesh = *read_[index];
    if (mesh.primitives.empty()) return;
    const auto has_joints = [](const Primitive& p) { return !p.joints.empty(); };
    const bool skinned = use.skin >= 0 && std::all_of(mesh.primitives.begin(), mesh.primitives.end(), has_joints);
    if (use.skin >= 0 && !skinned) {
      document_.warn("gltf-skin", "has a skin, but its mesh has primitives without joints: it stays as it is",
                     use.pointer);
    }
    Node& target = scene_.nodes[node];
    target.mesh = skinned ? add_skinned(mesh, use) : add_plain(index);
    target.skin = skinned ? use.skin : -1;
    scene_.instances.push_back({target.mesh, static_cast<int>(node), glm::dmat4(1)});
  }

  /// The mesh for all nodes that place it by their matrix.
  int add_plain(std::size_t index) {
    if (plain_[index] >= 0) return plain_[index];
    Mesh mesh;
    if (skinned_uses_[index]) {
      mesh = *read_[index];
    } else {
      std::swap(mesh, *read_[index]);
      read_[index]->primitives.resize(mesh.primitives.size());  // still known not to be empty
    }
    for (Primitive& primitive : mesh.primitives) {
      primitive.joints.clear();
      primitive.weights.clear();
    }
    scene_.meshes.push_back(std::move(mesh));
    return plain_[index] = static_cast<int>(scene_.meshes.size()) - 1;
  }

  Mesh read_mesh(std::size_t index, const std::vector<LoadedMaterial>& materials) {
    const Value& value = mesh_values_[index];
    Mesh mesh;
    mesh.name = value.text("name");
    const std::vector<Value> primitives = value.items("primitives");
    if (primitives.empty()) value.fail("gltf-missing", "has no primitives");
    for (const Value& primitive : primitives) {
      if (primitive.has("targets")) note_morph(value);
      if (std::optional<Primitive> read =
              read_primitive(document_, primitive, materials, skinned_uses_[index], report_)) {
        mesh.primitives.push_back(std::move(*read));
      }
    }
    return mesh;
  }

  void note_morph(const Value& mesh) {
    for (const Value& weight : mesh.items("weights")) {
      if (weight.json().is_number() && weight.json().get<double>() != 0) {
        document_.warn("gltf-morph", "its morph targets are not supported: the base shape is drawn", mesh.pointer());
        return;
      }
    }
  }

  /// A copy for one node that a skin moves: joints checked, the rest pose set aside.
  int add_skinned(Mesh mesh, const NodeUse& use) {
    const std::size_t joints = scene_.skins[static_cast<std::size_t>(use.skin)].joints.size();
    for (Primitive& p : mesh.primitives) {
      document_.spend(p.positions.size(), use.pointer);
      for (std::size_t i = 0; i < p.joints.size(); ++i) {
        for (int c = 0; c < 4; ++c) {
          if (p.weights[i][c] == 0) {
            p.joints[i][c] = 0;
          } else if (p.joints[i][c] >= joints) {
            document_.fail(use.pointer, "gltf-index",
                           "its mesh refers to joint " + std::to_string(p.joints[i][c]) + ", but the skin has " +
                               std::to_string(joints));
          }
        }
      }
      p.rest_positions = p.positions;
      p.rest_normals = p.normals;
      p.rest_tangents = p.tangents;
    }
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<int>(scene_.meshes.size()) - 1;
  }

  void place_light(std::size_t node, const NodeUse& use, const std::vector<Light>& lights) {
    if (use.light < 0) return;
    Light light = lights[static_cast<std::size_t>(use.light)];
    if (light.name.empty()) light.name = scene_.nodes[node].name;
    scene_.nodes[node].light = static_cast<int>(scene_.lights.size());
    scene_.lights.push_back(std::move(light));
  }

  void place_camera(std::size_t node, const NodeUse& use, const std::vector<Camera>& cameras) {
    if (use.camera < 0) return;
    Camera camera = cameras[static_cast<std::size_t>(use.camera)];
    if (camera.name.empty()) camera.name = scene_.nodes[node].name;
    scene_.nodes[node].camera = static_cast<int>(scene_.cameras.size());
    scene_.cameras.push_back(std::move(camera));
  }

  void finish_materials(const std::vector<LoadedMaterial>& materials) {
    scene_.images = images_.finish();
    for (const LoadedMaterial& loaded : materials) {
      scene_.materials.push_back(loaded.material);
      drop_failed_images(scene_.materials.back(), images_);
    }
    const int neutral = static_cast<int>(scene_.materials.size());
    bool needed = materials.empty();
    for (Mesh& mesh : scene_.meshes) {
      for (Primitive& primitive : mesh.primitives) {
        if (primitive.material >= 0) continue;
        primitive.material = neutral;
        needed = true;
      }
    }
    if (needed) scene_.materials.push_back(neutral_material());
    warn_of_black_metals();
  }

  /// metallicFactor is 1 where a file leaves it out, and a metal has no diffuse albedo.
  void warn_of_black_metals() {
    std::set<int> black;
    for (const Mesh& mesh : scene_.meshes) {
      for (const Primitive& primitive : mesh.primitives) {
        const Material& m = scene_.materials[static_cast<std::size_t>(primitive.material)];
        if (m.metallic == 1 && m.metallic_roughness_texture.image < 0 && m.emissive == glm::vec3(0)) {
          black.insert(primitive.material);
        }
      }
    }
    for (const int i : black) {
      const std::string& name = scene_.materials[static_cast<std::size_t>(i)].name;
      document_.warn(
          "gltf-metal",
          "the material \"" + name + "\" is a metal through and through: it reflects no diffuse light and looks black",
          "/materials/" + std::to_string(i), "give it a metallicFactor below 1 (the default is 1)");
    }
  }

  void report() {
    const auto warn = [&](std::size_t count, const char* code, const std::string& what) {
      if (count > 0) document_.warn(code, std::to_string(count) + what);
    };
    warn(report_.points_and_lines, "gltf-points-lines",
         " primitive(s) of points or lines are left out: only triangles are drawn");
    warn(report_.without_positions, "gltf-no-positions", " primitive(s) without positions are left out");
    warn(report_.without_material, "gltf-no-material",
         " primitive(s) have no material and are drawn as a white, diffuse surface (glTF's default is a metal, which "
         "has "
         "no diffuse light)");
    warn(report_.without_texcoords, "gltf-texcoord",
         " textured primitive(s) lack the texture coordinates that their material reads: the corner texel is used");
    warn(report_.extra_influences, "gltf-skin",
         " primitive(s) have more than four joints a vertex: the first four are used");
    warn(report_.repairs.non_finite, "gltf-non-finite", " triangle(s) with a vertex that is not finite are left out");
    const auto note = [&](std::size_t count, const char* code, const std::string& what) {
      if (count > 0) document_.note(code, std::to_string(count) + what);
    };
    note(report_.repairs.zero_area, "gltf-zero-area", " triangle(s) without area are left out");
    note(report_.repairs.bad_normals, "gltf-normals", " normal(s) of no length were replaced by those of the faces");
    if (scene_.instances.empty())
      document_.warn("gltf-empty", "there is nothing to draw: no triangle is part of the scene");
  }

  Document document_;
  Images images_;
  Scene scene_;
  std::vector<Value> mesh_values_;
  std::vector<std::optional<Mesh>> read_;  ///< by the file's number
  std::vector<int> plain_;                 ///< by the file's number: Scene::meshes, −1 = not there yet
  std::vector<bool> skinned_uses_;
  MeshReport report_;
};

}  // namespace

Scene load(const std::string& path, Diagnostics& diagnostics, bool outside) {
  try {
    return Loader(path, diagnostics, outside).load();
  } catch (const std::bad_alloc&) {
    throw Error(path + ": the memory does not suffice to load it");
  }
}

}  // namespace gltf

Scene load_gltf(const std::string& path, Diagnostics& diagnostics, LoadOptions options) {
  Scene scene = gltf::load(path, diagnostics, options.allow_outside);
  scene.content_hash = content_hash(scene);
  return scene;
}

}  // namespace loom::scene
