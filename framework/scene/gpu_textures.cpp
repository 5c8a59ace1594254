#include "scene/gpu_textures.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "loom/diagnostic.h"

namespace loom::scene {
namespace {

/// Samples along the footprint's long axis: a floor seen at grazing angles down to 1/8 stays sharp across.
constexpr float anisotropy = 8;

/// False for Mesa's software drivers: they walk every texel of the footprint, which takes seconds a frame and does not
/// end where a derivative is not finite.
bool filters_anisotropically() {
  const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view renderer = text != nullptr ? text : "";
  if (renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe")) return false;
  // Core since 4.6; before, the extension of the same token.
  return epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic") ||
         epoxy_has_gl_extension("GL_ARB_texture_filter_anisotropic");
}

GlName make_sampler(bool repeat_u, bool repeat_v, bool nearest) {
  GlName sampler = 0;
  glCreateSamplers(1, &sampler);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, repeat_u ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, repeat_v ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, nearest ? GL_NEAREST : GL_LINEAR);
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, nearest ? GL_NEAREST_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
  if (filters_anisotropically() && !nearest) {
    float largest = 1;
    glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY, &largest);
    glSamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY, std::min(anisotropy, largest));
  }
  return sampler;
}

}  // namespace

MaterialTextures::MaterialTextures(const Scene& scene) {
  for (int i = 0; i < 8; ++i) samplers_.push_back(make_sampler((i & 1) != 0, (i & 2) != 0, (i & 4) != 0));
  glCreateTextures(GL_TEXTURE_2D, 1, &white_);
  glTextureStorage2D(white_, 1, GL_RGBA8, 1, 1);
  const std::array<std::uint8_t, 4> white{255, 255, 255, 255};
  glClearTexImage(white_, 0, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
  for (const Material& material : scene.materials) {
    for (const MaterialSampler& sampler : material_samplers) {
      const TextureRef& ref = material.*sampler.ref;
      const Image* image = image_of(scene, ref);
      if (image != nullptr && !textures_.contains({ref.image, sampler.encoding})) {
        upload(*image, ref.image, sampler.encoding);
      }
    }
  }
}

MaterialTextures::~MaterialTextures() {
  if (gpu::current_context() == nullptr) return;  // the context is gone, and its objects with it
  for (const auto& [key, name] : textures_) glDeleteTextures(1, &name);
  glDeleteTextures(1, &white_);
  glDeleteSamplers(static_cast<GLsizei>(samplers_.size()), samplers_.data());
}

void MaterialTextures::upload(const Image& image, int index, Encoding encoding) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (image.width > largest || image.height > largest) {
    throw Error("image '" + image.name + "' is " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                "; this device takes " + std::to_string(largest) + " texels a side");
  }
  GlName name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  textures_[{index, encoding}] = name;  // owned from here on
  const int levels = std::bit_width(static_cast<unsigned int>(std::max(image.width, image.height)));
  // Sixteen bits for what is linear: drivers may cut off, not round, when they average (llvmpipe does), .375 of a code
  // a level in the mean. Six levels up that tilts an eight-bit normal by a degree, and the light by a hundredth.
  const bool srgb = encoding == Encoding::srgb;
  glTextureStorage2D(name, levels, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA16, image.width, image.height);
  // An embedding program may have left other settings; rows here are packed and of four-byte texels.
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glTextureSubImage2D(name, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glGenerateTextureMipmap(name);
  gpu::label(GL_TEXTURE, name, image.name);
  bytes_ += image.rgba.size() / 3 * (srgb ? 4 : 8);
}

std::size_t MaterialTextures::sampler_index(const TextureRef& ref) {
  return (ref.repeat_u ? 1U : 0U) | (ref.repeat_v ? 2U : 0U) | (ref.nearest ? 4U : 0U);
}

MaterialTextures::Binding MaterialTextures::binding(const TextureRef& ref, Encoding encoding) const {
  const auto found = textures_.find({ref.image, encoding});
  return {.texture = found == textures_.end() ? white_ : found->second, .sampler = samplers_[sampler_index(ref)]};
}

}  // namespace loom::scene
