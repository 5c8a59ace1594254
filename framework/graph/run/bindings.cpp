#include "graph/run/bindings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "gpu/program.h"
#include "loom/diagnostic.h"

namespace loom::graph {
namespace {

bool is_image_access(Access access) {
  return access == Access::image_read || access == Access::image_write || access == Access::image_read_write;
}

}  // namespace

PassBindings::PassBindings(const CompiledPass& pass, const CompiledGraph& graph, const Storage& storage,
                           BundleStructs& structs, const KeepTracker& keep, const bool& history_valid)
    : pass_(pass), graph_(graph), storage_(storage), structs_(structs), keep_(keep), history_valid_(history_valid) {
  for (const BoundPort& port : pass.bound) {
    for (const BoundMember& member : port.members) {
      for (auto* map : {&paths_, &symbols_}) {
        const char separator = map == &paths_ ? '.' : '_';
        Entry& entry = (*map)[port.name + separator + member.name];
        // An in-place output bears the name of its input where both are called the same: the output's access holds.
        if (entry.port != &port) entry.members.clear();
        entry.port = &port;
        entry.members.push_back(&member);
      }
    }
  }
}

void PassBindings::fail(const std::string& message, const std::string& hint) const {
  Diagnostics diagnostics;
  diagnostics.error("bind", fmt::format("pass '{}' ({}): {}", pass_.name, pass_.type, message), pass_.where, hint);
  throw Error(std::move(diagnostics));
}

const PassBindings::Entry* PassBindings::find(std::string_view path) const {
  const auto it = paths_.find(path);
  return it == paths_.end() ? nullptr : &it->second;
}

const BoundPort& PassBindings::port(std::string_view name) const {
  const auto it = std::find_if(pass_.bound.begin(), pass_.bound.end(), [&](const auto& p) { return p.name == name; });
  if (it != pass_.bound.end()) return *it;
  std::vector<std::string> names;
  for (const BoundPort& p : pass_.bound) names.push_back(p.name);
  const std::string near = nearest_name(name, names);
  fail(fmt::format("it has no port '{}'", name), near.empty() ? "" : fmt::format("did you mean '{}'?", near));
}

const BoundMember& PassBindings::member(std::string_view path) const {
  if (const Entry* entry = find(path)) return *entry->members.front();
  std::vector<std::string> names;
  for (const auto& [name, entry] : paths_) names.push_back(name);
  const std::string near = nearest_name(path, names);
  fail(fmt::format("it has no '{}'", path), near.empty() ? "" : fmt::format("did you mean '{}'?", near));
}

int PassBindings::resource(std::string_view path, bool texture) const {
  const BoundMember& m = member(path);
  if (!m.declared)
    fail(fmt::format("it touches {}, which it does not declare", path), "declare it in reflect(): reads(\"…\")");
  if (m.resource == none)
    fail(fmt::format("{} is not made", path), "nobody reads it, or its producer does not make it: ask has() first");
  const bool is_texture =
      std::holds_alternative<TextureDesc>(graph_.resources[static_cast<std::size_t>(m.resource)].desc);
  if (is_texture != texture) fail(fmt::format("{} is a {}", path, is_texture ? "texture" : "buffer"));
  return m.resource;
}

const Texture& PassBindings::texture(std::string_view path) const {
  const Texture* texture = storage_.texture(resource(path, true));
  if (!texture) fail(fmt::format("{} is an external input that has not been set", path));
  return *texture;
}

const Buffer& PassBindings::buffer(std::string_view path) const {
  const Buffer* buffer = storage_.buffer(resource(path, false));
  if (!buffer) fail(fmt::format("{} is an external input that has not been set", path));
  return *buffer;
}

bool PassBindings::has(std::string_view path) const {
  const Entry* entry = find(path);
  return entry && entry->members.front()->declared && entry->members.front()->resource != none;
}

bool PassBindings::absent(std::string_view input) const {
  const BoundPort& p = port(input);
  return !p.connected || p.absent.has_value();
}

bool PassBindings::history_valid(std::string_view input) const {
  const BoundPort& p = port(input);
  return p.history && p.connected && !p.absent && history_valid_;
}

bool PassBindings::kept() const { return keep_.kept(pass_); }

std::uint64_t PassBindings::revision(std::string_view input) const { return keep_.revision(pass_, port(input).name); }

void PassBindings::publish_bytes(std::string_view output, std::span<const std::byte> data) const {
  const BoundPort& p = port(output);
  if (p.is_input) fail(fmt::format("'{}' is an input: only its producer publishes its struct", output));
  if (p.bundle != none) structs_.publish(p.bundle, data, pass_.name + "." + p.name);
}

std::span<const std::byte> PassBindings::data_bytes(std::string_view name, std::size_t bytes) const {
  const BoundPort& p = port(name);
  if (p.bundle == none) fail(fmt::format("'{}' carries nothing, so that it has no struct", name), "ask absent() first");
  return structs_.data(p.bundle, bytes, pass_.name + "." + p.name);
}

const BindPlan& PassBindings::plan(const Program& program) const {
  const auto it = plans_.find(&program);
  return it != plans_.end() ? it->second : plans_.emplace(&program, make_plan(program)).first->second;
}

// The member that a shader name means, or null where the name is none of the framework's (the pass binds it itself).
const BoundMember* PassBindings::answer(const std::string& name, std::string_view as, bool image, bool block) const {
  const auto it = symbols_.find(name);
  if (it == symbols_.end()) {
    for (const BoundPort& p : pass_.bound)
      if (name.starts_with(p.name + "_"))
        fail(fmt::format("its shader names the {} {}, but '{}' has no such member{}", as, name, p.name,
                         p.connected && !p.absent ? "" : " (it carries nothing)"),
             "guard it by a #define where it may be missing");
    return nullptr;
  }
  const Entry& entry = it->second;
  const BoundMember& first = *entry.members.front();
  if (first.resource == none)
    fail(fmt::format("its shader names the {} {}, but {}.{} is not made", as, name, entry.port->name, first.name),
         "guard it by a #define: bindings.has()");
  if (!first.declared)
    fail(fmt::format("its shader names the {} {}, but the pass does not declare that it touches {}.{}", as, name,
                     entry.port->name, first.name),
         fmt::format("declare reads(\"{}\") in reflect()", first.name));
  const bool buffer =
      std::holds_alternative<BufferDesc>(graph_.resources[static_cast<std::size_t>(first.resource)].desc);
  if (buffer != block)
    fail(fmt::format("its shader names the {} {}, but {}.{} is a {}", as, name, entry.port->name, first.name,
                     buffer ? "buffer" : "texture"));
  // A pass may sample what it has written itself, after Frame::barrier().
  const auto fits = [&](const BoundMember* m) {
    return image ? is_image_access(m->access) : m->access == Access::sampled;
  };
  if (!block && (entry.port->is_input || image) && std::none_of(entry.members.begin(), entry.members.end(), fits))
    fail(fmt::format("its shader names the {} {}, but {}.{} is declared with access {}", as, name, entry.port->name,
                     first.name, to_string(first.access)),
         "memory is ordered by the declared access: declare what the shader does");
  const auto match = std::find_if(entry.members.begin(), entry.members.end(), fits);
  return match == entry.members.end() ? &first : *match;
}

BindPlan PassBindings::make_plan(const Program& program) const {
  BindPlan plan;
  const ProgramInterface& wanted = program.interface();
  for (const auto& sampler : wanted.samplers) {
    const auto unit = static_cast<GlName>(sampler.location_or_binding);
    const bool shadow = gpu::is_shadow_sampler(sampler.gl_type);
    if (const BoundMember* m = answer(sampler.name, "sampler", false, false))
      plan.textures.push_back({unit, m->resource, {}, shadow});
    else if (sampler.name.starts_with("scene_"))
      plan.textures.push_back({unit, none, sampler.name, shadow});
  }
  for (const auto& image : wanted.images)
    if (const BoundMember* m = answer(image.name, "image", true, false))
      plan.images.push_back({static_cast<GlName>(image.location_or_binding), m->resource, m->access});
  for (const auto& block : wanted.storage_blocks) {
    const auto binding = static_cast<GlName>(block.location_or_binding);
    if (const BoundMember* m = answer(block.name, "storage block", false, true))
      plan.storage.push_back({binding, m->resource, {}});
    else if (block.name.starts_with("scene_"))
      plan.storage.push_back({binding, none, block.name});
  }
  for (const auto& block : wanted.uniform_blocks) {
    const auto binding = static_cast<GlName>(block.location_or_binding);
    if (block.name == "frame_data") {
      plan.blocks.push_back({binding, none});
      continue;
    }
    if (!block.name.ends_with("_data")) continue;
    const std::string_view name = std::string_view(block.name).substr(0, block.name.size() - 5);
    const auto p = std::find_if(pass_.bound.begin(), pass_.bound.end(), [&](const auto& b) { return b.name == name; });
    if (p == pass_.bound.end()) continue;
    if (p->bundle == none || !structs_.buffer(p->bundle))
      fail(fmt::format("its shader names the uniform block {}, but '{}' carries no struct", block.name, name),
           "guard it by a #define: bindings.absent()");
    plan.blocks.push_back({binding, p->bundle});
  }
  for (const auto& uniform : wanted.uniforms)
    if (const ParamDecl* param = pass_.params.find(uniform.name); param && param->kind != ParamKind::text)
      plan.params.push_back({uniform.name, param});
  return plan;
}

}  // namespace loom::graph
