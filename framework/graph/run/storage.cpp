#include "graph/run/storage.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <glm/vec4.hpp>

#include "gpu/format.h"
#include "loom/diagnostic.h"

namespace loom::graph {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool same_shape(const TextureDesc& a, const TextureDesc& b) {
  return a.format == b.format && a.kind == b.kind && a.width == b.width && a.height == b.height && a.depth == b.depth &&
         a.mips == b.mips;
}

// What the texture is, whatever its owner says: empty where it matches.
std::string mismatch(GlName name, const TextureDesc& desc) {
  if (!glIsTexture(name)) return fmt::format("{} is no texture in this context", name);
  GLint width = 0, height = 0, internal = 0, target = 0;
  glGetTextureParameteriv(name, GL_TEXTURE_TARGET, &target);
  if (static_cast<GLenum>(target) != gpu::gl_target(desc.kind))
    return fmt::format("the texture is not of kind {}", to_string(desc.kind));
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_WIDTH, &width);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_HEIGHT, &height);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_INTERNAL_FORMAT, &internal);
  if (width != desc.width || height != desc.height) return fmt::format("the texture is {}x{}", width, height);
  if (static_cast<GLenum>(internal) != gpu::gl_format(desc.format).internal)
    return fmt::format("the texture's internal format is {:#x}", internal);
  return {};
}

}  // namespace

Storage::Storage(const CompiledGraph& graph) : graph_(graph) {
  std::vector<std::string_view> labels(graph.slots.size());
  for (const Resource& resource : graph.resources)
    if (resource.slot != none && labels[index(resource.slot)].empty()) labels[index(resource.slot)] = resource.name;
  for (std::size_t i = 0; i < graph.slots.size(); ++i) {
    if (const auto* texture = std::get_if<TextureDesc>(&graph.slots[i].desc)) {
      slots_.emplace_back(std::in_place_type<Texture>, *texture, labels[i]);
      std::get<Texture>(slots_.back()).clear(glm::vec4(0));
    } else {
      slots_.emplace_back(std::in_place_type<Buffer>, graph.slots[i].bytes, labels[i]);
    }
  }
  externals_.resize(graph.resources.size());
  for (const Resource& resource : graph.resources) {
    slot_of_.push_back(resource.slot);
    const bool view = resource.slot != none && std::holds_alternative<BufferDesc>(resource.desc);
    views_.push_back(Buffer::borrow(view ? std::get<Buffer>(slots_[index(resource.slot)]).name() : 0,
                                    view ? std::get<BufferDesc>(resource.desc).bytes : 0));
  }
  reset();
}

const Resource& Storage::at(int resource) const { return graph_.resources[index(resource)]; }

const Texture* Storage::texture(int resource) const {
  const int slot = slot_of_[index(resource)];
  return std::get_if<Texture>(slot == none ? &externals_[index(resource)] : &slots_[index(slot)]);
}

const Buffer* Storage::buffer(int resource) const {
  if (slot_of_[index(resource)] == none) return std::get_if<Buffer>(&externals_[index(resource)]);
  const Buffer& view = views_[index(resource)];
  return view.name() == 0 ? nullptr : &view;
}

void Storage::reset() {
  for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
    const auto lifetime = graph_.resources[i].lifetime;
    if (lifetime == Resource::Lifetime::history || lifetime == Resource::Lifetime::persistent)
      clear(static_cast<int>(i));
  }
}

void Storage::swap_history() {
  for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
    if (graph_.resources[i].history_of == none) continue;
    const std::size_t now = index(graph_.resources[i].history_of);
    std::swap(slot_of_[i], slot_of_[now]);
    std::swap(views_[i], views_[now]);
  }
}

Adopted Storage::adopt(const Storage& from) const {
  Adopted adopted;
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
    const Resource& wanted = graph_.resources[i];
    const bool history = wanted.lifetime == Resource::Lifetime::history;
    if (!history && wanted.lifetime != Resource::Lifetime::persistent) continue;
    const auto& candidates = from.graph_.resources;
    const auto old = std::find_if(candidates.begin(), candidates.end(), [&](const Resource& r) {
      return r.name == wanted.name && r.lifetime == wanted.lifetime && r.desc == wanted.desc;
    });
    if (old == candidates.end()) {
      (history ? adopted.history : adopted.persistent) = false;
      continue;
    }
    copy(from, static_cast<int>(old - candidates.begin()), static_cast<int>(i));
  }
  return adopted;
}

void Storage::copy(const Storage& from, int source, int target) const {
  if (const Texture* to = texture(target)) {
    const TextureDesc& desc = to->desc();
    const GLenum kind = gpu::gl_target(desc.kind);
    for (int mip = 0; mip < desc.mips; ++mip) {
      const int depth = desc.kind == TextureKind::d3 ? std::max(desc.depth >> mip, 1) : desc.depth;
      glCopyImageSubData(from.texture(source)->name(), kind, mip, 0, 0, 0, to->name(), kind, mip, 0, 0, 0,
                         std::max(desc.width >> mip, 1), std::max(desc.height >> mip, 1), depth);
    }
  } else if (const Buffer* bytes = buffer(target)) {
    bytes->copy(*from.buffer(source));
  }
}

void Storage::clear(int resource) const {
  if (const Texture* t = texture(resource)) t->clear(at(resource).clear);
  if (const Buffer* b = buffer(resource)) b->clear();
}

void Storage::poison(int resource) const {
  constexpr std::uint32_t all = 0xffffffffu;
  if (const Buffer* b = buffer(resource); b && b->bytes() >= 4)
    glClearNamedBufferSubData(b->name(), GL_R32UI, 0, static_cast<GLsizeiptr>(b->bytes() / 4 * 4), GL_RED_INTEGER,
                              GL_UNSIGNED_INT, &all);
  const Texture* t = texture(resource);
  if (!t) return;
  if (!is_integer(t->desc().format)) {
    const bool normalised =
        t->desc().format == Format::r8 || t->desc().format == Format::rg8 || t->desc().format == Format::rgba8;
    t->clear(glm::vec4(normalised ? 1.f : std::numeric_limits<float>::quiet_NaN()));
    return;
  }
  constexpr std::array<std::uint32_t, 4> bits{all, all, all, all};
  const gpu::GlFormat format = gpu::gl_format(t->desc().format);
  for (int mip = 0; mip < t->desc().mips; ++mip)
    glClearTexImage(t->name(), mip, format.read_layout, format.read_type, bits.data());
}

void Storage::set_external(std::string_view name, std::string_view member, GlName texture, const TextureDesc& desc) {
  const std::string path = fmt::format("inputs.{}.{}", name, member);
  std::vector<std::string> known;
  for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
    const Resource& resource = graph_.resources[i];
    if (resource.lifetime != Resource::Lifetime::external) continue;
    known.push_back(resource.name);
    if (resource.name != path) continue;
    const auto* wanted = std::get_if<TextureDesc>(&resource.desc);
    const std::string found = wanted && same_shape(*wanted, desc) ? mismatch(texture, desc) : to_string(desc);
    if (!found.empty())
      throw BadInput({.code = "input-mismatch",
                      .message = fmt::format("{} is declared as {}, but was given {}", path,
                                             wanted ? to_string(*wanted) : "a buffer", found),
                      .hint = "hand in what the graph was compiled for, or compile it again"});
    externals_[i] = Texture::borrow(texture, desc);
    return;
  }
  const std::string near = nearest_name(path, known);
  throw BadInput({.code = "unknown-input",
                  .message = fmt::format("the graph reads no {}", path),
                  .hint = near.empty() ? "nothing that is read needs it" : fmt::format("did you mean {}?", near)});
}

void Storage::require_externals() const {
  for (std::size_t i = 0; i < graph_.resources.size(); ++i) {
    const bool missing = graph_.resources[i].lifetime == Resource::Lifetime::external &&
                         std::holds_alternative<std::monostate>(externals_[i]);
    if (missing)
      throw Error(fmt::format("external input {} has not been set: call set_input()", graph_.resources[i].name));
  }
}

}  // namespace loom::graph
