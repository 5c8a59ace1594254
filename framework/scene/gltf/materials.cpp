#include "scene/gltf/materials.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

namespace loom::scene::gltf {
namespace {

constexpr int gl_clamp_to_edge = 33071;
constexpr int gl_mirrored_repeat = 33648;
constexpr int gl_repeat = 10497;
constexpr int gl_nearest = 9728;

std::vector<TextureRef*> textures_of(Material& material) {
  return {&material.base_color_texture, &material.metallic_roughness_texture, &material.normal_texture,
          &material.emissive_texture};
}

class MaterialReader {
 public:
  MaterialReader(Document& document, Images& images)
      : document_(document),
        images_(images),
        textures_(document.root().items("textures")),
        samplers_(document.root().items("samplers")),
        image_count_(document.root().items("images").size()) {}

  LoadedMaterial read(const Value& value) {
    LoadedMaterial loaded;
    loaded.pointer = value.pointer();
    Material& material = loaded.material;
    material.name = value.text("name");
    if (const std::optional<Value> diffuse = value.extension("KHR_materials_pbrSpecularGlossiness")) {
      read_specular_glossiness(*diffuse, material);
    } else {
      read_metallic_roughness(value, material);
    }
    const auto emissive = value.numbers<3>("emissiveFactor", {0, 0, 0});
    double strength = 1;
    if (const std::optional<Value> extension = value.extension("KHR_materials_emissive_strength")) {
      strength = extension->number("emissiveStrength", 1, 0);
    }
    for (int c = 0; c < 3; ++c) {
      material.emissive[c] =
          static_cast<float>(clamped(value, "emissiveFactor", emissive[static_cast<std::size_t>(c)], 0, 1) * strength);
    }
    read_dielectric(value, material);
    material.emissive_texture = read_texture(value, "emissiveTexture");
    if (material.emissive == glm::vec3(0)) material.emissive_texture.image = -1;
    material.normal_texture = read_texture(value, "normalTexture");
    if (const std::optional<Value> normal = value.find("normalTexture")) {
      material.normal_scale = static_cast<float>(normal->number("scale", 1));
    }
    read_alpha(value, material);
    material.double_sided = value.flag("doubleSided", false);
    assign_uv_sets(loaded);
    return loaded;
  }

 private:
  /// Values outside the schema's range are held at it, with a warning.
  double clamped(const Value& where, std::string_view key, double value, double low, double high) {
    if (value >= low && value <= high) return value;
    document_.warn("gltf-range", std::string(key) + " is held within its range", where.pointer());
    return std::clamp(value, low, high);
  }

  void read_metallic_roughness(const Value& value, Material& material) {
    material.metallic = 1;
    material.roughness = 1;
    const std::optional<Value> pbr = value.find("pbrMetallicRoughness");
    if (!pbr) return;
    const auto color = pbr->numbers<4>("baseColorFactor", {1, 1, 1, 1});
    for (int c = 0; c < 4; ++c) {
      material.base_color[c] =
          static_cast<float>(clamped(*pbr, "baseColorFactor", color[static_cast<std::size_t>(c)], 0, 1));
    }
    material.metallic = static_cast<float>(clamped(*pbr, "metallicFactor", pbr->number("metallicFactor", 1), 0, 1));
    material.roughness = static_cast<float>(clamped(*pbr, "roughnessFactor", pbr->number("roughnessFactor", 1), 0, 1));
    material.base_color_texture = read_texture(*pbr, "baseColorTexture");
    material.metallic_roughness_texture = read_texture(*pbr, "metallicRoughnessTexture");
  }

  /// KHR_materials_pbrSpecularGlossiness: the diffuse part is the base colour of a dielectric.
  void read_specular_glossiness(const Value& value, Material& material) {
    const auto color = value.numbers<4>("diffuseFactor", {1, 1, 1, 1});
    for (int c = 0; c < 4; ++c) {
      material.base_color[c] =
          static_cast<float>(clamped(value, "diffuseFactor", color[static_cast<std::size_t>(c)], 0, 1));
    }
    material.base_color_texture = read_texture(value, "diffuseTexture");
    material.metallic = 0;
    material.roughness =
        1 - static_cast<float>(clamped(value, "glossinessFactor", value.number("glossinessFactor", 1), 0, 1));
  }

  void read_dielectric(const Value& value, Material& material) {
    if (const std::optional<Value> extension = value.extension("KHR_materials_ior")) {
      // 0 stands for an infinite index in the extension, which reflects everything: a metal says that better.
      const double ior = extension->number("ior", material.ior);
      material.ior = static_cast<float>(clamped(*extension, "ior", ior, 1, 100));
    }
    if (const std::optional<Value> extension = value.extension("KHR_materials_transmission")) {
      const double factor = extension->number("transmissionFactor", 0);
      material.transmission = static_cast<float>(clamped(*extension, "transmissionFactor", factor, 0, 1));
      if (extension->find("transmissionTexture")) {
        document_.warn("gltf-texture", "a texture of transmission is not read: the factor counts everywhere",
                       extension->pointer());
      }
    }
  }

  void read_alpha(const Value& value, Material& material) {
    const std::string mode = value.text("alphaMode", "OPAQUE");
    if (mode == "MASK") {
      material.alpha = AlphaMode::mask;
      material.alpha_cutoff = static_cast<float>(value.number("alphaCutoff", .5, 0));
    } else if (mode == "BLEND") {
      material.alpha = AlphaMode::mask;
      material.alpha_cutoff = .5f;
      document_.warn("gltf-blend",
                     "the blended material \"" + material.name + "\" counts as opaque where its alpha is .5 or more",
                     value.pointer());
    } else if (mode != "OPAQUE") {
      document_.warn("gltf-range", "alphaMode \"" + mode + "\" is unknown and read as OPAQUE", value.pointer());
    }
  }

  TextureRef read_texture(const Value& owner, std::string_view key) {
    TextureRef result;
    const std::optional<Value> info = owner.find(key);
    if (!info) return result;
    const Value& texture =
        textures_[static_cast<std::size_t>(info->required_index("index", textures_.size(), "textures"))];
    const int image = texture.index("source", image_count_, "images");
    result.uv_set = static_cast<int>(info->integer("texCoord", 0, 0, 1 << 16));
    bool mirror_u = false;
    bool mirror_v = false;
    if (const int sampler = texture.index("sampler", samplers_.size(), "samplers"); sampler >= 0) {
      const Value& value = samplers_[static_cast<std::size_t>(sampler)];
      result.repeat_u = read_wrap(value, "wrapS", mirror_u);
      result.repeat_v = read_wrap(value, "wrapT", mirror_v);
      result.nearest = value.integer("magFilter", 9729, 9728, 9729) == gl_nearest;
    }
    if (const std::optional<Value> transform = info->extension("KHR_texture_transform")) {
      result.transform = read_transform(*transform);
      result.uv_set = static_cast<int>(transform->integer("texCoord", result.uv_set, 0, 1 << 16));
    }
    // The mirrored tile lies in the same image: half the coordinate, period 1.
    if (mirror_u) scale_row(result.transform, 0, .5f);
    if (mirror_v) scale_row(result.transform, 1, .5f);
    if (image < 0) {
      document_.warn("gltf-image", "the texture has no PNG or JPEG source and is left out", texture.pointer());
      return result;
    }
    result.image = images_.use(image, mirror_u, mirror_v);
    return result;
  }

  bool read_wrap(const Value& sampler, std::string_view key, bool& mirror) {
    const auto mode = sampler.integer(key, gl_repeat, 0, 1 << 16);
    mirror = mode == gl_mirrored_repeat;
    if (mode != gl_repeat && mode != gl_clamp_to_edge && !mirror) {
      sampler.require(key).fail("gltf-range", "is no wrapping mode");
    }
    return mode != gl_clamp_to_edge;
  }

  static void scale_row(glm::mat3x2& matrix, int row, float factor) {
    for (int column = 0; column < 3; ++column) matrix[column][row] *= factor;
  }

  /// uv' = T·R·S·uv, the rotation counter-clockwise in a frame whose v points down.
  static glm::mat3x2 read_transform(const Value& value) {
    const auto offset = value.numbers<2>("offset", {0, 0});
    const auto scale = value.numbers<2>("scale", {1, 1});
    const double angle = value.number("rotation", 0);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const auto f = [](double x) { return static_cast<float>(x); };
    return {f(c * scale[0]), f(-s * scale[0]), f(s * scale[1]), f(c * scale[1]), f(offset[0]), f(offset[1])};
  }

  /// A primitive keeps two sets of coordinates: those that the material reads.
  void assign_uv_sets(LoadedMaterial& loaded) {
    std::vector<int> sets;
    for (const TextureRef* texture : textures_of(loaded.material)) {
      if (texture->image >= 0) sets.push_back(texture->uv_set);
    }
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    // Sets 0 and 1 keep their places where that is possible, so that what a primitive holds is what the file calls so.
    if (sets.size() == 1 && sets[0] == 1) {
      loaded.uv_sets = {0, 1};
    } else {
      for (std::size_t i = 0; i < std::min<std::size_t>(2, sets.size()); ++i) loaded.uv_sets[i] = sets[i];
    }
    for (TextureRef* texture : textures_of(loaded.material)) {
      if (texture->image < 0) {
        texture->uv_set = 0;
        continue;
      }
      const auto slot = std::find(loaded.uv_sets.begin(), loaded.uv_sets.end(), texture->uv_set);
      if (slot == loaded.uv_sets.end()) {
        document_.warn("gltf-texcoord",
                       "a texture that reads TEXCOORD_" + std::to_string(texture->uv_set) +
                           " is left out: a material may use two sets",
                       loaded.pointer);
        *texture = {};
      } else {
        texture->uv_set = static_cast<int>(std::distance(loaded.uv_sets.begin(), slot));
      }
    }
  }

  Document& document_;
  Images& images_;
  std::vector<Value> textures_, samplers_;
  std::size_t image_count_;
};

}  // namespace

std::vector<LoadedMaterial> read_materials(Document& document, Images& images) {
  MaterialReader reader(document, images);
  std::vector<LoadedMaterial> materials;
  for (const Value& value : document.root().items("materials")) materials.push_back(reader.read(value));
  return materials;
}

Material neutral_material() {
  Material material;
  material.name = "neutral";
  material.metallic = 0;
  return material;
}

void drop_failed_images(Material& material, const Images& images) {
  for (TextureRef* texture : textures_of(material)) {
    if (texture->image >= 0 && !images.ok(texture->image)) *texture = {};
  }
}

}  // namespace loom::scene::gltf
