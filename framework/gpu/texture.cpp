#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "gpu/format.h"
#include "gpu/read_region.h"
#include "loom/diagnostic.h"
#include "loom/gpu.h"

namespace loom {
namespace {

GLenum min_filter(const TextureDesc& desc) {
  const bool linear = desc.filter == Filter::linear;
  if (desc.mips > 1) return linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_NEAREST;
  return linear ? GL_LINEAR : GL_NEAREST;
}

void check_size(const TextureDesc& desc, std::string_view label) {
  GLint limit = 0, layer_limit = 0;
  const bool volume = desc.kind == TextureKind::d3;
  glGetIntegerv(volume ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE, &limit);
  glGetIntegerv(volume ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_ARRAY_TEXTURE_LAYERS, &layer_limit);
  const bool fits = desc.width >= 1 && desc.height >= 1 && desc.depth >= 1 && desc.mips >= 1 && desc.width <= limit &&
                    desc.height <= limit && desc.depth <= layer_limit;
  if (!fits)
    throw Error("texture '" + std::string(label) + "' (" + to_string(desc) + ") does not fit this device: sides of 1…" +
                std::to_string(limit) + ", 1…" + std::to_string(layer_limit) + " layers");
}

bool two_channels(Format format) {
  return format == Format::rg8 || format == Format::rg16f || format == Format::rg32f || format == Format::rg32ui;
}

glm::ivec3 level_size(const TextureDesc& desc, int mip) {
  const auto shrink = [mip](int n) { return std::max(1, n >> mip); };
  return {shrink(desc.width), shrink(desc.height), desc.kind == TextureKind::d3 ? shrink(desc.depth) : desc.depth};
}

int layers_of(const TextureDesc& desc) {
  if (desc.kind == TextureKind::d2) return 1;
  return desc.kind == TextureKind::cube ? 6 : desc.depth;
}

std::size_t texels_of(const TextureDesc& desc, int mip) {
  const glm::ivec3 size = level_size(desc, mip);
  const int layers = desc.kind == TextureKind::d3 ? size.z : layers_of(desc);
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(layers);
}

// Pixel transfers read client memory only where no buffer is bound to the pixel targets, as an embedding program may
// have left one; and rows are packed.
class PlainTransfer {
 public:
  explicit PlainTransfer(bool reading)
      : target_(reading ? GL_PIXEL_PACK_BUFFER : GL_PIXEL_UNPACK_BUFFER),
        alignment_(reading ? GL_PACK_ALIGNMENT : GL_UNPACK_ALIGNMENT) {
    glGetIntegerv(reading ? GL_PIXEL_PACK_BUFFER_BINDING : GL_PIXEL_UNPACK_BUFFER_BINDING, &buffer_);
    glGetIntegerv(alignment_, &old_alignment_);
    glBindBuffer(target_, 0);
    glPixelStorei(alignment_, 1);
  }
  ~PlainTransfer() {
    glPixelStorei(alignment_, old_alignment_);
    glBindBuffer(target_, static_cast<GLuint>(buffer_));
  }
  PlainTransfer(const PlainTransfer&) = delete;
  PlainTransfer& operator=(const PlainTransfer&) = delete;

 private:
  GLenum target_, alignment_;
  GLint buffer_ = 0, old_alignment_ = 4;
};

}  // namespace

Texture::Texture(const TextureDesc& desc, std::string_view label) : desc_(desc) {
  check_size(desc, label);
  const gpu::GlFormat format = gpu::gl_format(desc.format);
  while (glGetError() != GL_NO_ERROR) {
  }
  glCreateTextures(gpu::gl_target(desc.kind), 1, &name_);
  context_ = gpu::current_context();
  const bool flat = desc.kind == TextureKind::d2 || desc.kind == TextureKind::cube;
  if (flat)
    glTextureStorage2D(name_, desc.mips, format.internal, desc.width, desc.height);
  else
    glTextureStorage3D(name_, desc.mips, format.internal, desc.width, desc.height, desc.depth);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    glDeleteTextures(1, &name_);
    name_ = 0;
    throw Error("cannot allocate texture '" + std::string(label) + "' (" + to_string(desc) + ", " +
                std::to_string(byte_size(desc)) +
                " bytes): " + (error == GL_OUT_OF_MEMORY ? "out of memory" : "GL error " + std::to_string(error)));
  }
  glTextureParameteri(name_, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(min_filter(desc)));
  glTextureParameteri(name_, GL_TEXTURE_MAG_FILTER, desc.filter == Filter::linear ? GL_LINEAR : GL_NEAREST);
  const GLint wrap = desc.wrap == Wrap::repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(name_, axis, wrap);
  if (desc.grey) {
    const GLint channels[] = {GL_RED, GL_RED, GL_RED, two_channels(desc.format) ? GL_GREEN : GL_ONE};
    glTextureParameteriv(name_, GL_TEXTURE_SWIZZLE_RGBA, channels);
  }
  gpu::label(GL_TEXTURE, name_, label);
}

Texture Texture::borrow(GlName name, const TextureDesc& desc) {
  Texture texture;
  texture.name_ = name;
  texture.owned_ = false;
  texture.desc_ = desc;
  return texture;
}

Texture::~Texture() {
  // Where the context is gone, so is the texture; in another context the name means something else.
  if (name_ && owned_ && gpu::current_context() == context_) glDeleteTextures(1, &name_);
}

Texture::Texture(Texture&& other) noexcept
    : name_(std::exchange(other.name_, 0)), owned_(other.owned_), context_(other.context_), desc_(other.desc_) {}

Texture& Texture::operator=(Texture&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(owned_, other.owned_);
  std::swap(context_, other.context_);
  std::swap(desc_, other.desc_);
  return *this;
}

void Texture::clear(glm::vec4 value) const {
  const gpu::GlFormat format = gpu::gl_format(desc_.format);
  for (int mip = 0; mip < desc_.mips; ++mip) {
    if (format.read_type == GL_FLOAT) {
      glClearTexImage(name_, mip, format.read_layout, GL_FLOAT, &value.x);
    } else if (format.read_type == GL_INT) {
      const glm::ivec4 integer(value);
      glClearTexImage(name_, mip, format.read_layout, GL_INT, &integer.x);
    } else {
      const glm::uvec4 integer(value);
      glClearTexImage(name_, mip, format.read_layout, GL_UNSIGNED_INT, &integer.x);
    }
  }
}

std::vector<glm::vec4> Texture::read(int mip) const {
  const glm::ivec3 size = level_size(desc_, mip);
  return gpu::read_region(*this, mip, glm::ivec3(0),
                          {size.x, size.y, desc_.kind == TextureKind::d3 ? size.z : layers_of(desc_)});
}

std::vector<glm::vec4> gpu::read_region(const Texture& texture, int mip, glm::ivec3 lower, glm::ivec3 size) {
  const TextureDesc& desc = texture.desc();
  const GlFormat format = gl_format(desc.format);
  const std::size_t count =
      static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
  std::vector<glm::vec4> result(count);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  const PlainTransfer transfer(true);
  const auto fetch = [&](GLenum type, std::size_t bytes, void* to) {
    glGetTextureSubImage(texture.name(), mip, lower.x, lower.y, lower.z, size.x, size.y, size.z, format.read_layout,
                         type, static_cast<GLsizei>(bytes), to);
  };
  if (is_depth(desc.format)) {
    std::vector<float> depth(count);
    fetch(GL_FLOAT, count * sizeof(float), depth.data());
    for (std::size_t i = 0; i < count; ++i) result[i] = {depth[i], 0, 0, 1};
  } else if (is_integer(desc.format)) {
    std::vector<glm::uvec4> integers(count);
    fetch(format.read_type, count * sizeof(glm::uvec4), integers.data());
    const bool is_signed = format.read_type == GL_INT;
    for (std::size_t i = 0; i < count; ++i)
      result[i] = is_signed ? glm::vec4(glm::ivec4(integers[i])) : glm::vec4(integers[i]);
  } else {
    fetch(GL_FLOAT, count * sizeof(glm::vec4), result.data());
  }
  // A transfer does not see how samplers read the texture.
  if (desc.grey) {
    for (glm::vec4& texel : result) texel = {texel.r, texel.r, texel.r, two_channels(desc.format) ? texel.g : 1};
  }
  return result;
}

void Texture::write(std::span<const std::byte> texels, int mip) const {
  const gpu::GlFormat format = gpu::gl_format(desc_.format);
  const std::size_t expected = texels_of(desc_, mip) * bytes_per_texel(desc_.format);
  if (mip < 0 || mip >= desc_.mips || texels.size() != expected)
    throw Error("writing " + std::to_string(texels.size()) + " bytes to mip " + std::to_string(mip) + " of a " +
                to_string(desc_) + " texture, which takes " + std::to_string(expected));
  const glm::ivec3 size = level_size(desc_, mip);
  const PlainTransfer transfer(false);
  if (desc_.kind == TextureKind::d2)
    glTextureSubImage2D(name_, mip, 0, 0, size.x, size.y, format.layout, format.type, texels.data());
  else
    glTextureSubImage3D(name_, mip, 0, 0, 0, size.x, size.y, desc_.kind == TextureKind::d3 ? size.z : layers_of(desc_),
                        format.layout, format.type, texels.data());
}

}  // namespace loom
