#include "graph/run/gl_state.h"

#include <epoxy/gl.h>

#include <cstddef>

namespace loom::graph {
namespace {

constexpr std::array<GLenum, 12> off{GL_BLEND,
                                     GL_CULL_FACE,
                                     GL_DEPTH_TEST,
                                     GL_SCISSOR_TEST,
                                     GL_STENCIL_TEST,
                                     GL_COLOR_LOGIC_OP,
                                     GL_DITHER,
                                     GL_FRAMEBUFFER_SRGB,
                                     GL_POLYGON_OFFSET_FILL,
                                     GL_RASTERIZER_DISCARD,
                                     GL_PRIMITIVE_RESTART,
                                     GL_DEPTH_CLAMP};

void enable(GLenum capability, bool on) { on ? glEnable(capability) : glDisable(capability); }

int get(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

GLenum as_enum(int value) { return static_cast<GLenum>(value); }
GLuint as_name(int value) { return static_cast<GLuint>(value); }

}  // namespace

void set_known_state() {
  for (const GLenum capability : off) glDisable(capability);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_GREATER);
  glBlendFunc(GL_ONE, GL_ZERO);
  glBlendEquation(GL_FUNC_ADD);
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

SavedState::SavedState() {
  static_assert(off.size() + 1 == capability_count);
  for (std::size_t i = 0; i < off.size(); ++i) enabled_[i] = glIsEnabled(off[i]) == GL_TRUE;
  enabled_.back() = glIsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS) == GL_TRUE;
  program_ = get(GL_CURRENT_PROGRAM);
  draw_framebuffer_ = get(GL_DRAW_FRAMEBUFFER_BINDING);
  read_framebuffer_ = get(GL_READ_FRAMEBUFFER_BINDING);
  vertex_array_ = get(GL_VERTEX_ARRAY_BINDING);
  indirect_ = get(GL_DRAW_INDIRECT_BUFFER_BINDING);
  active_texture_ = get(GL_ACTIVE_TEXTURE);
  glGetIntegerv(GL_VIEWPORT, viewport_.data());
  constexpr std::array<GLenum, 6> blend{GL_BLEND_SRC_RGB,   GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,
                                        GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
  for (std::size_t i = 0; i < blend.size(); ++i) blend_[i] = get(blend[i]);
  glGetBooleanv(GL_COLOR_WRITEMASK, color_mask_.data());
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  depth_function_ = get(GL_DEPTH_FUNC);
  front_face_ = get(GL_FRONT_FACE);
  clip_origin_ = get(GL_CLIP_ORIGIN);
  clip_depth_ = get(GL_CLIP_DEPTH_MODE);
  glGetIntegerv(GL_POLYGON_MODE, polygon_mode_.data());
}

SavedState::~SavedState() {
  for (std::size_t i = 0; i < off.size(); ++i) enable(off[i], enabled_[i]);
  enable(GL_TEXTURE_CUBE_MAP_SEAMLESS, enabled_.back());
  // A current program that was deleted meanwhile is gone for good once another takes its place.
  glUseProgram(glIsProgram(as_name(program_)) == GL_TRUE ? as_name(program_) : 0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, as_name(draw_framebuffer_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, as_name(read_framebuffer_));
  glBindVertexArray(as_name(vertex_array_));
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, as_name(indirect_));
  glActiveTexture(as_enum(active_texture_));
  glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  glBlendFuncSeparate(as_enum(blend_[0]), as_enum(blend_[1]), as_enum(blend_[2]), as_enum(blend_[3]));
  glBlendEquationSeparate(as_enum(blend_[4]), as_enum(blend_[5]));
  glColorMask(color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
  glDepthMask(depth_mask_);
  glDepthFunc(as_enum(depth_function_));
  glFrontFace(as_enum(front_face_));
  glClipControl(as_enum(clip_origin_), as_enum(clip_depth_));
  glPolygonMode(GL_FRONT_AND_BACK, as_enum(polygon_mode_[0]));
}

}  // namespace loom::graph
