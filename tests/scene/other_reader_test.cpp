// The loader against an independent reader of the same files, tinygltf: triangles at their place in the world,
// materials, lights and cameras. What tinygltf does not decode (Draco, meshopt, sparse accessors) or pose (skins) is
// left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "files.h"
#include "scene/load.h"

#define TINYGLTF_NO_STB_IMAGE_WRITE
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace loom::test {
namespace {

/// What is in a scene. Of all triangles: sums that any order of them gives.
struct Soup {
  std::size_t triangles = 0, lights = 0, cameras = 0;
  double area = 0;
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  glm::dvec3 moment{0};  ///< Σ area · centroid

  void add(const std::array<glm::dvec3, 3>& corners) {
    const double size = .5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    ++triangles;
    area += size;
    for (const glm::dvec3& corner : corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
      moment += size / 3 * corner;
    }
  }
};

double number(const unsigned char* at, int type, bool normalized) {
  const auto read = [&](auto value) {
    std::memcpy(&value, at, sizeof(value));
    const auto x = static_cast<double>(value);
    using T = decltype(value);
    return normalized ? std::max(x / static_cast<double>(std::numeric_limits<T>::max()), -1.) : x;
  };
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return read(std::int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return read(std::uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return read(std::int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return read(std::uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<double>([&] {
        std::uint32_t value = 0;
        std::memcpy(&value, at, sizeof(value));
        return value;
      }());
    default: {
      float value = 0;
      std::memcpy(&value, at, sizeof(value));
      return value;
    }
  }
}

/// Component `c` of element `i` of an accessor.
double element(const tinygltf::Model& model, int accessor_index, std::size_t i, std::size_t c) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const auto& data = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  const auto size =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const auto stride = static_cast<std::size_t>(accessor.ByteStride(view));
  return number(&data.at(view.byteOffset + accessor.byteOffset + i * stride + c * size), accessor.componentType,
                accessor.normalized);
}

glm::dmat4 local_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 m(1);
  if (node.translation.size() == 3) m = glm::translate(m, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    m = m * glm::mat4_cast(
                glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
  if (node.scale.size() == 3) m = glm::scale(m, glm::make_vec3(node.scale.data()));
  return m;
}

void add_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const glm::dmat4& world,
                   Soup& soup) {
  const int positions = primitive.attributes.at("POSITION");
  const std::size_t count = primitive.indices >= 0
                                ? model.accessors.at(static_cast<std::size_t>(primitive.indices)).count
                                : model.accessors.at(static_cast<std::size_t>(positions)).count;
  for (std::size_t i = 0; i + 2 < count; i += 3) {
    std::array<glm::dvec3, 3> own{}, corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex =
          primitive.indices >= 0 ? static_cast<std::size_t>(element(model, primitive.indices, i + k, 0)) : i + k;
      own.at(k) = {element(model, positions, vertex, 0), element(model, positions, vertex, 1),
                   element(model, positions, vertex, 2)};
      corners.at(k) = glm::dvec3(world * glm::dvec4(own.at(k), 1));
    }
    // The loader leaves out what has no area, and says so.
    if (glm::cross(own[1] - own[0], own[2] - own[0]) != glm::dvec3(0)) soup.add(corners);
  }
}

void add_node(const tinygltf::Model& model, int index, const glm::dmat4& parent, Soup& soup) {
  const tinygltf::Node& node = model.nodes.at(static_cast<std::size_t>(index));
  const glm::dmat4 world = parent * local_matrix(node);
  soup.lights += node.extensions.count("KHR_lights_punctual");
  soup.cameras += node.camera >= 0 ? 1 : 0;
  if (node.mesh >= 0)
    for (const auto& primitive : model.meshes.at(static_cast<std::size_t>(node.mesh)).primitives)
      if (primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode < 0) add_primitive(model, primitive, world, soup);
  for (const int child : node.children) add_node(model, child, world, soup);
}

Soup soup_of(const scene::Scene& scene) {
  Soup soup;
  for (const scene::Instance& instance : scene.instances) {
    for (const scene::Primitive& primitive : scene.meshes.at(static_cast<std::size_t>(instance.mesh)).primitives) {
      for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
        std::array<glm::dvec3, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k)
          corners.at(k) =
              glm::dvec3(instance.world * glm::dvec4(primitive.positions.at(primitive.indices.at(i + k)), 1)) +
              scene.origin;
        soup.add(corners);
      }
    }
  }
  return soup;
}

bool within_reach(const tinygltf::Model& model) {
  const auto uses = [&](const char* extension) {
    return std::find(model.extensionsUsed.begin(), model.extensionsUsed.end(), extension) != model.extensionsUsed.end();
  };
  const bool sparse = std::any_of(model.accessors.begin(), model.accessors.end(),
                                  [](const tinygltf::Accessor& a) { return a.sparse.isSparse; });
  const bool other_modes = std::any_of(model.meshes.begin(), model.meshes.end(), [](const tinygltf::Mesh& mesh) {
    return std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                       [](const auto& p) { return p.mode != TINYGLTF_MODE_TRIANGLES && p.mode >= 0; });
  });
  return !uses("KHR_draco_mesh_compression") && !uses("EXT_meshopt_compression") && !sparse && !other_modes &&
         model.skins.empty();
}

tinygltf::Model read(const std::filesystem::path& path, bool& read_it) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  read_it = path.extension() == ".glb" ? loader.LoadBinaryFromFile(&model, &error, &warning, path.string())
                                       : loader.LoadASCIIFromFile(&model, &error, &warning, path.string());
  return model;
}

std::vector<std::filesystem::path> files() {
  std::vector<std::filesystem::path> found;
  for (const std::filesystem::path& root :
       {std::filesystem::path(LOOM_SOURCE_DIR "/configs/scenes"), scenes_folder()}) {
    if (root.empty()) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const auto extension = entry.path().extension();
      const bool broken = entry.path().string().find("invalid-gltf") != std::string::npos;
      if ((extension == ".gltf" || extension == ".glb") && !broken) found.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// A number of a material's extension, or what stands where it is missing.
float number_of(const tinygltf::Material& material, const char* extension, const char* key, double missing) {
  const auto found = material.extensions.find(extension);
  if (found == material.extensions.end() || !found->second.Has(key)) return static_cast<float>(missing);
  return static_cast<float>(found->second.Get(key).GetNumberAsDouble());
}

TEST(OtherReader, FindsTheSameTrianglesMaterialsLightsAndCameras) {
  std::size_t compared = 0;
  for (const std::filesystem::path& path : files()) {
    SCOPED_TRACE(path);
    bool read_it = false;
    const tinygltf::Model model = read(path, read_it);
    if (!read_it || !within_reach(model)) continue;
    ++compared;
    Diagnostics diagnostics;
    const scene::Scene scene = scene::load_gltf(path.string(), diagnostics);
    Soup expected;
    const auto& roots = model.scenes.at(static_cast<std::size_t>(std::max(model.defaultScene, 0))).nodes;
    for (const int root : roots) add_node(model, root, glm::dmat4(1), expected);
    const Soup soup = soup_of(scene);
    EXPECT_EQ(soup.triangles, expected.triangles);
    // Positions are floats in both; matrices double.
    const double size = glm::length(expected.high - expected.low);
    EXPECT_NEAR(soup.area, expected.area, 1e-6 * expected.area);
    EXPECT_LE(glm::length(soup.low - expected.low), 1e-6 * size);
    EXPECT_LE(glm::length(soup.high - expected.high), 1e-6 * size);
    EXPECT_LE(glm::length(soup.moment - expected.moment), 1e-6 * expected.area * (size + glm::length(expected.low)));
    EXPECT_EQ(scene.lights.size(), expected.lights);
    EXPECT_EQ(scene.cameras.size(), expected.cameras);
    for (std::size_t i = 0; i < model.materials.size() && i < scene.materials.size(); ++i) {
      if (model.materials[i].extensions.count("KHR_materials_pbrSpecularGlossiness") != 0) continue;
      const auto& other = model.materials[i].pbrMetallicRoughness;
      for (int c = 0; c < 4; ++c)
        EXPECT_FLOAT_EQ(scene.materials[i].base_color[c],
                        static_cast<float>(other.baseColorFactor.at(static_cast<std::size_t>(c))))
            << i;
      EXPECT_FLOAT_EQ(scene.materials[i].metallic, static_cast<float>(other.metallicFactor)) << i;
      EXPECT_FLOAT_EQ(scene.materials[i].roughness, static_cast<float>(other.roughnessFactor)) << i;
      EXPECT_EQ(scene.materials[i].double_sided, model.materials[i].doubleSided) << i;
      EXPECT_FLOAT_EQ(scene.materials[i].ior, number_of(model.materials[i], "KHR_materials_ior", "ior", 1.5)) << i;
      EXPECT_FLOAT_EQ(scene.materials[i].transmission,
                      number_of(model.materials[i], "KHR_materials_transmission", "transmissionFactor", 0))
          << i;
      EXPECT_EQ(scene.materials[i].metallic_roughness_texture.image >= 0, other.metallicRoughnessTexture.index >= 0)
          << i;
    }
  }
  EXPECT_GE(compared, scenes_folder().empty() ? 3u : 20u);
}

}  // namespace
}  // namespace loom::test
