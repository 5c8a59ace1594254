#include "viewer/volume_overlay.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <span>

#include <glm/geometric.hpp>

#include "graph/run/gl_state.h"

namespace loom::viewer {
namespace {

/// Surfaces hide what is behind them. Alpha is not looked at: a leaf hides as a whole.
void draw_scene_depth(const Model& model, const glm::mat4& view_proj) {
  const auto program = model.programs().program({.files = {"viewer/depth.vert", "viewer/depth.frag"}, .defines = {}});
  glUseProgram(program->name());
  program->set("view_proj", view_proj);
  for (const auto& block : program->interface().storage_blocks)
    if (const Buffer* buffer = model.gpu_scene().buffer(block.name); buffer != nullptr && buffer->bytes() > 0)
      glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(block.location_or_binding), buffer->name());
  model.gpu_scene().draw(*program);
}

}  // namespace

VolumeOverlay::~VolumeOverlay() {
  if (vertex_array_ != 0) glDeleteVertexArrays(1, &vertex_array_);
  if (framebuffer_ != 0) glDeleteFramebuffers(1, &framebuffer_);
}

void VolumeOverlay::update(const Model& model, const VolumeSettings& settings, const TextureViewSettings& view,
                           glm::ivec2 size) {
  if (!settings.on || !model.inspects_volume() || size.x < 1 || size.y < 1) {
    drawn_ = false;
    name_.clear();
    return;
  }
  follow(model, settings, view);
  const bool same = drawn_ && drawn_mesh_ == mesh_version_ && drawn_view_ == model.view_version() && colour_ &&
                    colour_->desc().width == size.x && colour_->desc().height == size.y;
  if (!same) draw(model, size);
  drawn_ = true;
  drawn_mesh_ = mesh_version_;
  drawn_view_ = model.view_version();
}

void VolumeOverlay::follow(const Model& model, const VolumeSettings& settings, const TextureViewSettings& view) {
  const std::uint32_t texture = model.inspected_texture()->name();
  if (name_ == model.inspected() && texture_ == texture && version_ == model.inspected_version() &&
      settings_ == settings && view_ == view)
    return;
  name_ = model.inspected();
  texture_ = texture;
  version_ = model.inspected_version();
  settings_ = settings;
  view_ = view;
  ++mesh_version_;
  const std::optional<VolumeSource> source = model.inspected_volume();
  mesh_ = source ? make_cells(*source, settings, view) : CellMesh{};
  parts_ = source ? part_count(*source) : 1;
  if (mesh_.indices.empty()) return;
  vertices_ = std::make_unique<Buffer>(std::as_bytes(std::span(mesh_.vertices)), "inspector cells");
  indices_ = std::make_unique<Buffer>(std::as_bytes(std::span(mesh_.indices)), "inspector cells");
}

void VolumeOverlay::draw(const Model& model, glm::ivec2 size) {
  const graph::SavedState saved;
  graph::set_known_state();
  if (!colour_ || colour_->desc().width != size.x || colour_->desc().height != size.y) {
    colour_ = std::make_unique<Texture>(TextureDesc::image(size, Format::rgba8), "inspector volume");
    depth_ = std::make_unique<Texture>(TextureDesc::image(size, Format::depth32f), "inspector volume depth");
    if (framebuffer_ == 0) glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, colour_->name(), 0);
    glNamedFramebufferTexture(framebuffer_, GL_DEPTH_ATTACHMENT, depth_->name(), 0);
  }
  if (vertex_array_ == 0) {
    glCreateVertexArrays(1, &vertex_array_);
    glEnableVertexArrayAttrib(vertex_array_, 0);
    glVertexArrayAttribFormat(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE, offsetof(CellVertex, position));
    glVertexArrayAttribBinding(vertex_array_, 0, 0);
    glEnableVertexArrayAttrib(vertex_array_, 1);
    glVertexArrayAttribFormat(vertex_array_, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(CellVertex, rgba));
    glVertexArrayAttribBinding(vertex_array_, 1, 0);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, size.x, size.y);
  const float nothing[4] = {}, far = 0;
  glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &far);
  if (mesh_.indices.empty()) return;
  glEnable(GL_DEPTH_TEST);
  const glm::mat4 view_proj = scene::make_camera(model.camera(), model.box(), size).view_proj;
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  draw_scene_depth(model, view_proj);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const auto program = model.programs().program({.files = {"viewer/cells.vert", "viewer/cells.frag"}, .defines = {}});
  glUseProgram(program->name());
  program->set("view_proj", view_proj);
  glVertexArrayVertexBuffer(vertex_array_, 0, vertices_->name(), 0, sizeof(CellVertex));
  glVertexArrayElementBuffer(vertex_array_, indices_->name());
  glBindVertexArray(vertex_array_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh_.indices.size()), GL_UNSIGNED_INT, nullptr);
}

std::string VolumeOverlay::text_at(const Model& model, glm::vec2 at) const {
  if (!drawn_ || !colour_) return {};
  const interop::Camera camera =
      scene::make_camera(model.camera(), model.box(), {colour_->desc().width, colour_->desc().height});
  const glm::vec2 s = 2.F * at - 1.F;
  const glm::vec3 across = s.x * glm::vec3(camera.right) + s.y * glm::vec3(camera.up);
  const bool orthographic = camera.eye.w > .5F;
  const glm::vec3 origin = glm::vec3(camera.eye) + (orthographic ? across : glm::vec3(0));
  const int hit = hit_body(mesh_, origin, glm::vec3(camera.forward) + (orthographic ? glm::vec3(0) : across));
  if (hit < 0) return {};
  const CellBody& body = mesh_.bodies[static_cast<std::size_t>(hit)];
  return fmt::format("({}, {}, {})  {:.4g}, {:.4g}, {:.4g}, {:.4g}", body.cell.x, body.cell.y, body.cell.z,
                     body.value.x, body.value.y, body.value.z, body.value.w);
}

}  // namespace loom::viewer
