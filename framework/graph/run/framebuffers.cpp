#include "graph/run/framebuffers.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <utility>

#include "gpu/current.h"
#include "gpu/debug.h"
#include "gpu/format.h"
#include "loom/diagnostic.h"

namespace loom::graph {
namespace {

const Texture* first_of(const Attachments& attachments) {
  for (const Texture* texture : attachments.color)
    if (texture) return texture;
  return attachments.depth;
}

std::string describe(const Attachments& attachments) {
  std::string text;
  for (const Texture* texture : attachments.color)
    text += (text.empty() ? "" : ", ") + (texture ? to_string(texture->desc()) : std::string("none"));
  if (attachments.depth) text += (text.empty() ? "depth " : ", depth ") + to_string(attachments.depth->desc());
  return text;
}

// Why OpenGL does not take it, in terms of what was attached.
std::string reason(GLenum status, const Attachments& attachments) {
  const Texture* first = first_of(attachments);
  const auto differs = [&](const Texture* texture) {
    return texture && gpu::is_layered(texture->desc().kind) != gpu::is_layered(first->desc().kind);
  };
  bool mixed = differs(attachments.depth);
  for (const Texture* texture : attachments.color) mixed = mixed || differs(texture);
  if (mixed || status == GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS)
    return "layered and flat textures, or layered ones of different kinds, cannot be targets together";
  if (status == GL_FRAMEBUFFER_UNSUPPORTED) return "this device does not draw into that combination of formats";
  if (status == GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT) return "one of the formats cannot be drawn into";
  return fmt::format("status {:#x}", status);
}

}  // namespace

Framebuffer::Framebuffer() : context_(gpu::current_context()) { glCreateFramebuffers(1, &name_); }

Framebuffer::~Framebuffer() {
  if (name_ && gpu::current_context() == context_) glDeleteFramebuffers(1, &name_);
}

Framebuffer::Framebuffer(Framebuffer&& other) noexcept
    : name_(std::exchange(other.name_, 0)), context_(other.context_) {}

glm::ivec2 size_of(const Attachments& attachments) {
  const Texture* first = first_of(attachments);
  return first ? glm::ivec2(first->desc().width, first->desc().height) : attachments.empty_size;
}

int layers_of(const Attachments& attachments) {
  const Texture* first = first_of(attachments);
  if (!first || !gpu::is_layered(first->desc().kind)) return 1;
  return first->desc().kind == TextureKind::cube ? 6 : first->desc().depth;
}

GlName Framebuffers::get(const Attachments& attachments, const std::string& label) {
  key_.clear();
  key_.push_back(attachments.depth ? attachments.depth->name() : 0);
  for (const Texture* texture : attachments.color) key_.push_back(texture ? texture->name() : 0);
  const bool empty = !first_of(attachments);
  if (empty) {  // told apart by size alone
    key_.push_back(static_cast<GlName>(attachments.empty_size.x));
    key_.push_back(static_cast<GlName>(attachments.empty_size.y));
  }
  if (const auto it = made_.find(key_); it != made_.end()) return it->second.name();

  Framebuffer framebuffer;
  const GlName name = framebuffer.name();
  gpu::label(GL_FRAMEBUFFER, name, label);
  std::vector<GLenum> draw;
  for (std::size_t i = 0; i < attachments.color.size(); ++i) {
    const auto point = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + i);
    if (attachments.color[i]) glNamedFramebufferTexture(name, point, attachments.color[i]->name(), 0);
    draw.push_back(attachments.color[i] ? point : GL_NONE);
  }
  if (attachments.depth) glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, attachments.depth->name(), 0);
  if (draw.empty()) draw.push_back(GL_NONE);
  glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(draw.size()), draw.data());
  if (empty) {
    glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_WIDTH, attachments.empty_size.x);
    glNamedFramebufferParameteri(name, GL_FRAMEBUFFER_DEFAULT_HEIGHT, attachments.empty_size.y);
  }
  const GLenum status = glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw Error(fmt::format("cannot draw into {}: {}", describe(attachments), reason(status, attachments)));
  return made_.emplace(key_, std::move(framebuffer)).first->second.name();
}

}  // namespace loom::graph
