#include "gpu/format.h"

#include <epoxy/gl.h>

namespace loom::gpu {

GlFormat gl_format(Format format) {
  switch (format) {
    case Format::r8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE, GL_RGBA, GL_FLOAT, 1};
    case Format::rg8:
      return {GL_RG8, GL_RG, GL_UNSIGNED_BYTE, GL_RGBA, GL_FLOAT, 2};
    case Format::rgba8:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_RGBA, GL_FLOAT, 4};
    case Format::r16f:
      return {GL_R16F, GL_RED, GL_HALF_FLOAT, GL_RGBA, GL_FLOAT, 1};
    case Format::rg16f:
      return {GL_RG16F, GL_RG, GL_HALF_FLOAT, GL_RGBA, GL_FLOAT, 2};
    case Format::rgba16f:
      return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, GL_RGBA, GL_FLOAT, 4};
    case Format::r32f:
      return {GL_R32F, GL_RED, GL_FLOAT, GL_RGBA, GL_FLOAT, 1};
    case Format::rg32f:
      return {GL_RG32F, GL_RG, GL_FLOAT, GL_RGBA, GL_FLOAT, 2};
    case Format::rgba32f:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_RGBA, GL_FLOAT, 4};
    case Format::r11g11b10f:
      return {GL_R11F_G11F_B10F, GL_RGB, GL_UNSIGNED_INT_10F_11F_11F_REV, GL_RGBA, GL_FLOAT, 3};
    case Format::r32i:
      return {GL_R32I, GL_RED_INTEGER, GL_INT, GL_RGBA_INTEGER, GL_INT, 1};
    case Format::r32ui:
      return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 1};
    case Format::rg32ui:
      return {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 2};
    case Format::rgba32ui:
      return {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 4};
    case Format::depth32f:
      return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_COMPONENT, GL_FLOAT, 1};
  }
  return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, GL_RGBA, GL_FLOAT, 4};
}

unsigned int gl_target(TextureKind kind) {
  switch (kind) {
    case TextureKind::d2:
      return GL_TEXTURE_2D;
    case TextureKind::d2_array:
      return GL_TEXTURE_2D_ARRAY;
    case TextureKind::d3:
      return GL_TEXTURE_3D;
    case TextureKind::cube:
      return GL_TEXTURE_CUBE_MAP;
    case TextureKind::cube_array:
      return GL_TEXTURE_CUBE_MAP_ARRAY;
  }
  return GL_TEXTURE_2D;
}

bool is_layered(TextureKind kind) { return kind != TextureKind::d2; }

}  // namespace loom::gpu
