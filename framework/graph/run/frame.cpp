#include "graph/run/frame.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include <glm/vec4.hpp>

#include "gpu/current.h"
#include "gpu/format.h"
#include "graph/run/gl_state.h"
#include "interop/frame.h"
#include "loom/diagnostic.h"

namespace loom::graph {
namespace {

// Every Bindings that a pass is given is one of ours.
const PassBindings& ours(const Bindings& bindings) { return static_cast<const PassBindings&>(bindings); }

GLenum image_access(Access access) {
  if (access == Access::image_read) return GL_READ_ONLY;
  return access == Access::image_write ? GL_WRITE_ONLY : GL_READ_WRITE;
}

void set_param(const Program& program, const BindPlan::Uniform& uniform) {
  const ParamDecl& param = *uniform.param;
  if (const auto* const* b = std::get_if<bool*>(&param.target)) return program.set(uniform.name, **b ? 1 : 0);
  if (const auto* const* i = std::get_if<int*>(&param.target)) return program.set(uniform.name, **i);
  if (const auto* const* f = std::get_if<float*>(&param.target)) return program.set(uniform.name, **f);
  if (const auto* const* c = std::get_if<glm::vec3*>(&param.target)) return program.set(uniform.name, **c);
  const std::string& text = *std::get<std::string*>(param.target);
  const auto it = std::find(param.choices.begin(), param.choices.end(), text);
  program.set(uniform.name, static_cast<int>(it - param.choices.begin()));
}

int groups(int threads, int local) { return (threads + local - 1) / local; }

}  // namespace

VertexArray::VertexArray() : context_(gpu::current_context()) { glCreateVertexArrays(1, &name_); }
VertexArray::~VertexArray() {
  if (gpu::current_context() == context_) glDeleteVertexArrays(1, &name_);
}

ShadowSampler::ShadowSampler() : context_(gpu::current_context()) {
  glCreateSamplers(1, &name_);
  glSamplerParameteri(name_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glSamplerParameteri(name_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glSamplerParameteri(name_, axis, GL_CLAMP_TO_EDGE);
  glSamplerParameteri(name_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glSamplerParameteri(name_, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
}
ShadowSampler::~ShadowSampler() {
  if (gpu::current_context() == context_) glDeleteSamplers(1, &name_);
}

FrameRunner::FrameRunner(const CompiledGraph& graph, const Storage& storage, const BundleStructs& structs,
                         glm::ivec2 size)
    : graph_(graph),
      storage_(storage),
      structs_(structs),
      size_(size),
      frame_data_(sizeof(interop::FrameData), "frame_data"),
      nothing_(std::size_t{16}, "nothing") {}

void FrameRunner::begin_frame(const SceneView& scene, const interop::Camera& camera, const FrameInfo& info) {
  scene_ = &scene;
  camera_ = camera;
  info_ = info;
  const interop::FrameData data{
      .camera = camera,
      .random = {info.seed, static_cast<unsigned int>(info.index), static_cast<unsigned int>(info.sample),
                 static_cast<unsigned int>(info.samples)},
      .time = {static_cast<float>(info.time_s), static_cast<float>(info.dt_s), 0, 0},
      .sky = glm::vec4(scene.sky_radiance(), scene.sky_rotation() / (2 * std::numbers::pi))};
  frame_data_.write(std::as_bytes(std::span(&data, 1)));
}

void FrameRunner::begin_pass() {
  has_target_ = false;
  target_layers_ = 1;
  target_depth_ = false;
  set_known_state();
}

void FrameRunner::bind_resources(const BindPlan& plan) {
  for (const auto& t : plan.textures) {
    const Texture* texture = t.resource != none ? storage_.texture(t.resource) : scene_->texture(t.scene);
    glBindTextureUnit(t.unit, texture ? texture->name() : 0);
    glBindSampler(t.unit, t.shadow ? shadow_.name() : 0);
  }
  for (const auto& i : plan.images) {
    const Texture& texture = *storage_.texture(i.resource);
    glBindImageTexture(i.unit, texture.name(), 0, gpu::is_layered(texture.desc().kind) ? GL_TRUE : GL_FALSE, 0,
                       image_access(i.access), gpu::gl_format(texture.desc().format).internal);
  }
  for (const auto& s : plan.storage) {
    const Buffer* buffer = s.resource != none ? storage_.buffer(s.resource) : scene_->buffer(s.scene);
    if (!buffer || buffer->bytes() == 0) buffer = &nothing_;
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, s.binding, buffer->name(), 0, static_cast<GLsizeiptr>(buffer->bytes()));
  }
  for (const auto& b : plan.blocks)
    glBindBufferBase(GL_UNIFORM_BUFFER, b.binding,
                     (b.bundle == none ? frame_data_ : *structs_.buffer(b.bundle)).name());
}

void FrameRunner::bind(const Program& program, const Bindings& bindings) {
  const BindPlan& plan = ours(bindings).plan(program);
  glUseProgram(program.name());
  bind_resources(plan);
  for (const auto& uniform : plan.params) set_param(program, uniform);
}

void FrameRunner::dispatch(const Program& program, const Bindings& bindings, glm::ivec3 threads) {
  bind(program, bindings);
  if (threads.x <= 0 || threads.y <= 0 || threads.z <= 0) return;
  const glm::ivec3 local = program.local_size();
  glDispatchCompute(static_cast<GLuint>(groups(threads.x, local.x)), static_cast<GLuint>(groups(threads.y, local.y)),
                    static_cast<GLuint>(groups(threads.z, local.z)));
}

void FrameRunner::add_target(Targets& targets, const CompiledPass& pass, const BoundPort& port,
                             const BoundMember& member) {
  const bool depth = member.access == Access::depth;
  if (!depth && member.access != Access::color)
    throw Error(fmt::format("{}.{} is no target: it is declared with access {}", port.name, member.name,
                            to_string(member.access)));
  Target target;
  if (member.resource != none) {
    const Resource& resource = graph_.resources[static_cast<std::size_t>(member.resource)];
    target.texture = storage_.texture(member.resource);
    const bool in_place = std::any_of(pass.ports.outputs.begin(), pass.ports.outputs.end(),
                                      [&](const OutputDecl& o) { return o.name == port.name && o.in_place; });
    if (!in_place && resource.lifetime != Resource::Lifetime::persistent)
      target.clear = resource.clear_each_frame ? resource.clear : glm::vec4(0);
  } else if (depth) {
    target.texture = unread_depth(pass, port, member);
    target.clear = glm::vec4(0);
  }
  if (depth)
    targets.depth = target;
  else
    targets.color.push_back(target);
}

FrameRunner::Targets FrameRunner::all_targets(const PassBindings& bindings) {
  Targets targets;
  for (const BoundPort& port : bindings.pass().bound) {
    if (port.is_input) continue;
    for (const BoundMember& member : port.members)
      if (member.declared && (member.access == Access::color || member.access == Access::depth))
        add_target(targets, bindings.pass(), port, member);
  }
  return targets;
}

const Texture* FrameRunner::unread_depth(const CompiledPass& pass, const BoundPort& port, const BoundMember& member) {
  for (const auto& [of, texture] : unread_depths_)
    if (of == &member) return &texture;
  for (const OutputDecl& output : pass.ports.outputs)
    for (const MemberDecl& decl : output.members)
      if (output.name == port.name && decl.name == member.name)
        if (const auto* desc = std::get_if<TextureDesc>(&decl.desc)) {
          unread_depths_.emplace_back(&member,
                                      Texture(*desc, fmt::format("{}.{}.{}", pass.name, port.name, member.name)));
          return &unread_depths_.back().second;
        }
  return nullptr;
}

void FrameRunner::bind_targets(const PassBindings& bindings, const Targets& targets, bool clear) {
  Attachments attachments{.depth = targets.depth.texture, .empty_size = size_};
  for (const Target& target : targets.color) attachments.color.push_back(target.texture);
  const GlName framebuffer = framebuffers_.get(attachments, bindings.pass().name);
  const glm::ivec2 size = size_of(attachments);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, size.x, size.y);
  has_target_ = true;
  target_layers_ = layers_of(attachments);
  target_depth_ = targets.depth.texture != nullptr;
  (target_depth_ ? glEnable : glDisable)(GL_DEPTH_TEST);
  if (!clear) return;
  // Clears obey the masks, which a pass may have changed between two targets.
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  for (std::size_t i = 0; i < targets.color.size(); ++i) {
    const Target& target = targets.color[i];
    if (!target.texture || !target.clear) continue;
    const auto buffer = static_cast<GLint>(i);
    const GLenum type = gpu::gl_format(target.texture->desc().format).read_type;
    const glm::ivec4 integer(*target.clear);
    const glm::uvec4 natural(*target.clear);
    if (type == GL_INT)
      glClearNamedFramebufferiv(framebuffer, GL_COLOR, buffer, &integer.x);
    else if (type == GL_UNSIGNED_INT)
      glClearNamedFramebufferuiv(framebuffer, GL_COLOR, buffer, &natural.x);
    else
      glClearNamedFramebufferfv(framebuffer, GL_COLOR, buffer, &target.clear->x);
  }
  if (targets.depth.texture && targets.depth.clear)
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &targets.depth.clear->x);
}

void FrameRunner::begin_raster(const Bindings& bindings) {
  bind_targets(ours(bindings), all_targets(ours(bindings)), true);
}

FrameRunner::Targets FrameRunner::named_targets(const PassBindings& bindings,
                                                std::span<const std::string_view> members) {
  Targets targets;
  for (const std::string_view path : members) {
    const BoundMember& member = bindings.member(path);
    const auto owns = [&](const BoundPort& port) {
      return std::any_of(port.members.begin(), port.members.end(), [&](const auto& m) { return &m == &member; });
    };
    const auto port = std::find_if(bindings.pass().bound.begin(), bindings.pass().bound.end(), owns);
    add_target(targets, bindings.pass(), *port, member);
  }
  return targets;
}

void FrameRunner::begin_raster(const Bindings& bindings, std::span<const std::string_view> members) {
  bind_targets(ours(bindings), named_targets(ours(bindings), members), true);
}

void FrameRunner::continue_raster(const Bindings& bindings, std::span<const std::string_view> members) {
  bind_targets(ours(bindings), named_targets(ours(bindings), members), false);
}

void FrameRunner::blend(int index, Blend mode) {
  const auto target = static_cast<GLuint>(index);
  if (mode == Blend::replace) return glDisablei(GL_BLEND, target);
  glEnablei(GL_BLEND, target);
  glBlendFunci(target, GL_ONE, GL_ONE);
}

template <class Draw>
void FrameRunner::draw_undepthed(const Program& program, const PassBindings& bindings, Draw draw) {
  if (!has_target_) {
    Targets targets = all_targets(bindings);
    targets.depth = {};
    bind_targets(bindings, targets, false);
  }
  bind(program, bindings);
  glBindVertexArray(no_vertices_.name());
  if (target_depth_) glDisable(GL_DEPTH_TEST);
  draw();
  if (target_depth_) glEnable(GL_DEPTH_TEST);
}

void FrameRunner::fullscreen(const Program& program, const Bindings& bindings) {
  draw_undepthed(program, ours(bindings), [&] { glDrawArraysInstanced(GL_TRIANGLES, 0, 3, target_layers_); });
}

void FrameRunner::points(const Program& program, const Bindings& bindings, int count) {
  draw_undepthed(program, ours(bindings), [&] { glDrawArrays(GL_POINTS, 0, std::max(count, 0)); });
}

void FrameRunner::barrier() {
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

}  // namespace loom::graph
