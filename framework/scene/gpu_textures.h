#pragma once
// Textures and samplers of a scene's materials on the GPU.
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "loom/gpu.h"
#include "scene/scene.h"
#include "scene/texture.h"

namespace loom::scene {

/// Uploads each image once for each encoding it is read in, with all mip levels. Kept apart from loom::Texture, which
/// has no sRGB formats: what passes make is linear.
class MaterialTextures {
 public:
  explicit MaterialTextures(const Scene& scene);
  ~MaterialTextures();
  MaterialTextures(const MaterialTextures&) = delete;
  MaterialTextures& operator=(const MaterialTextures&) = delete;

  struct Binding {
    GlName texture = 0, sampler = 0;
  };
  /// White where the reference names no image.
  [[nodiscard]] Binding binding(const TextureRef& ref, Encoding encoding) const;
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void upload(const Image& image, int index, Encoding encoding);
  [[nodiscard]] static std::size_t sampler_index(const TextureRef& ref);

  std::map<std::pair<int, Encoding>, GlName> textures_;
  std::vector<GlName> samplers_;
  GlName white_ = 0;
  std::size_t bytes_ = 0;
};

/// What a program's sampler of each of these names reads of a material.
struct MaterialSampler {
  const char* name;
  TextureRef Material::*ref;
  Encoding encoding;
};
inline constexpr MaterialSampler material_samplers[] = {
    {"material_base_color", &Material::base_color_texture, Encoding::srgb},
    {"material_normal", &Material::normal_texture, Encoding::linear},
    {"material_emissive", &Material::emissive_texture, Encoding::srgb},
    {"material_metallic", &Material::metallic_roughness_texture, Encoding::linear},
};

}  // namespace loom::scene
