// Stage 6b: the textures and buffers that the passes which run need, and from when to when.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "graph/compile/plan.h"

namespace loom::graph {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::size_t bytes_of(const std::variant<TextureDesc, BufferDesc>& desc) {
  if (const auto* buffer = std::get_if<BufferDesc>(&desc)) return buffer->bytes;
  return byte_size(std::get<TextureDesc>(desc));
}

using Lifetime = Resource::Lifetime;

class ResourceMaker {
 public:
  ResourceMaker(Draft& draft, const Liveness& alive, CompiledGraph& graph)
      : draft_(draft), alive_(alive), graph_(graph) {
    position_.assign(draft.passes.size(), none);
    state_.resize(draft.passes.size());
    current_.resize(draft.versions.size());
    previous_.resize(draft.versions.size());
    bundle_.assign(draft.versions.size(), none);
    previous_bundle_.assign(draft.versions.size(), none);
  }

  void run() {
    for (const int pass : draft_.order)
      if (alive_.runs[at(pass)] != 0) {
        position_[at(pass)] = static_cast<int>(graph_.order.size());
        graph_.order.push_back(pass);
      }
    end_ = std::max(static_cast<int>(graph_.order.size()) - 1, 0);
    for (const auto& external : draft_.externals) make_bundle_members(external.version, Lifetime::external, none);
    for (const int pass : graph_.order) make_outputs(draft_.passes[at(pass)], pass);
    for (std::size_t v = 0; v < draft_.versions.size(); ++v) make_history(static_cast<int>(v));
    for (const auto& target : draft_.targets) make_target(target);
    for (std::size_t p = 0; p < draft_.passes.size(); ++p) {
      bind_pass(draft_.passes[p], static_cast<int>(p), graph_.passes[p]);
    }
  }

 private:
  int add(std::string name, const MemberDecl& decl, Lifetime lifetime, int first, int last) {
    Resource resource;
    resource.name = std::move(name);
    resource.desc = decl.desc;
    resource.bytes = bytes_of(decl.desc);
    resource.lifetime = lifetime;
    resource.first = first;
    resource.last = last;
    resource.clear = decl.clear;
    resource.clear_each_frame = decl.clear_each_frame;
    graph_.resources.push_back(std::move(resource));
    return static_cast<int>(graph_.resources.size()) - 1;
  }

  int add_bundle(int version, bool history) {
    const BundleInfo& info = draft_.versions[at(version)].info;
    const BundleType* type = draft_.registry->bundle(info.type);
    graph_.bundles.push_back({.name = draft_.version_name(version) + (history ? "@prev" : ""),
                              .type = info.type,
                              .struct_bytes = type == nullptr ? 0 : type->struct_bytes,
                              .attributes = info.attributes,
                              .history = history});
    return static_cast<int>(graph_.bundles.size()) - 1;
  }

  /// The members of a version that owns its storage.
  void make_bundle_members(int version, Lifetime lifetime, int first) {
    const auto& members = draft_.versions[at(version)].info.members;
    bundle_[at(version)] = add_bundle(version, false);
    auto& current = current_[at(version)];
    current.assign(members.size(), none);
    for (std::size_t m = 0; m < members.size(); ++m) {
      if (alive_.members[at(version)][m] == 0) continue;
      const bool whole_frame = lifetime == Lifetime::external || lifetime == Lifetime::kept;
      current[m] = add(draft_.version_name(version) + '.' + members[m].name, members[m], lifetime,
                       whole_frame ? 0 : first, whole_frame ? end_ : first);
    }
  }

  void make_outputs(DraftPass& pass, int index) {
    const int here = position_[at(index)];
    stop_keeping_if_changed(pass);
    for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i) {
      const int version = pass.versions[i];
      if (draft_.versions[at(version)].info.absent || pass.ports.outputs[i].forwards) continue;
      if (draft_.versions[at(version)].base == none) {
        make_bundle_members(version, pass.ports.keeps_outputs ? Lifetime::kept : Lifetime::transient, here);
      } else {
        const int root = draft_.versions[at(version)].root;
        for (const auto& [name, value] : draft_.versions[at(version)].info.attributes)
          graph_.bundles[at(bundle_[at(root)])].attributes.insert_or_assign(name, value);
        for (const int resource : current_[at(root)]) use(resource, here);
      }
    }
    for (const auto& wire : pass.wires) use_input(pass, wire, here);
    for (const auto& decl : pass.ports.scratches)
      state_[at(index)].push_back(add(pass.name() + ".scratch." + decl.name, decl, Lifetime::transient, here, here));
    for (const auto& decl : pass.ports.persistents)
      state_[at(index)].push_back(add(pass.name() + ".persistent." + decl.name, decl, Lifetime::persistent, 0, end_));
  }

  /// Outputs that another pass changes in place, or that are swapped with their last frame, do not stay as they are.
  void stop_keeping_if_changed(DraftPass& pass) {
    if (!pass.ports.keeps_outputs) return;
    for (std::size_t i = 0; i < pass.versions.size(); ++i) {
      const int root = draft_.versions[at(pass.versions[i])].root;
      const auto& history = alive_.history[at(root)];
      const bool swapped = std::find(history.begin(), history.end(), 1) != history.end();
      const bool own = draft_.versions[at(root)].pass == static_cast<int>(&pass - draft_.passes.data());
      if (alive_.overwritten[at(root)] == 0 && !(own && swapped)) continue;
      pass.ports.keeps_outputs = pass.ports.renews_parts = false;
      graph_.decisions.push_back({"static", "`" + pass.name() + "` runs every frame",
                                  '`' + draft_.version_name(pass.versions[i]) +
                                      (swapped ? "` is swapped with its last frame" : "` is changed in place")});
      return;
    }
  }

  void use(int resource, int position) {
    if (resource == none) return;
    auto& last = graph_.resources[at(resource)].last;
    last = std::max(last, position);
  }

  [[nodiscard]] static bool reads(const InputDecl& input, std::string_view member) {
    return input.reads_all || std::any_of(input.reads.begin(), input.reads.end(),
                                          [&](const ReadDecl& read) { return read.member == member; });
  }

  void use_input(const DraftPass& pass, const Wire& wire, int position) {
    const InputDecl* input = pass.input(wire.entry->input);
    if (input == nullptr || wire.version == none || wire.history()) return;
    const Version& version = draft_.versions[at(wire.version)];
    const auto& current = current_[at(version.root)];
    for (std::size_t m = 0; m < current.size(); ++m)
      if (reads(*input, version.info.members[m].name)) use(current[m], position);
  }

  void make_history(int version) {
    const auto& wanted = alive_.history[at(version)];
    if (std::find(wanted.begin(), wanted.end(), 1) == wanted.end()) return;
    const auto& members = draft_.versions[at(version)].info.members;
    previous_[at(version)].assign(members.size(), none);
    previous_bundle_[at(version)] = add_bundle(version, true);
    for (std::size_t m = 0; m < members.size(); ++m) {
      const int now = current_[at(version)][m];
      if (wanted[m] == 0 || now == none) continue;
      graph_.resources[at(now)].lifetime = Lifetime::history;
      graph_.resources[at(now)].last = end_;
      MemberDecl decl = members[m];
      decl.clear_each_frame = false;
      const int before = add(graph_.resources[at(now)].name + "@prev", decl, Lifetime::history, 0, end_);
      graph_.resources[at(before)].history_of = now;
      previous_[at(version)][m] = before;
    }
  }

  void make_target(const Target& target) {
    GraphOutput output{.name = target.name, .endpoint = target.endpoint, .quantity = target.quantity};
    output.absent = target.absent;
    if (target.version != none && !target.absent) {
      const Version& version = draft_.versions[at(target.version)];
      const auto& current = current_[at(version.root)];
      for (std::size_t m = 0; m < current.size(); ++m)
        if (version.info.members[m].name == target.member) output.resource = current[m];
      if (output.resource != none) {
        Resource& resource = graph_.resources[at(output.resource)];
        if (resource.lifetime == Lifetime::transient) resource.lifetime = Lifetime::output;
        resource.last = end_;
      }
      check_final(target);
    }
    graph_.outputs.push_back(std::move(output));
  }

  /// What is asked for is read after the frame, so nobody may have changed it by then.
  void check_final(const Target& target) {
    for (const auto& version : draft_.versions)
      if (version.base == target.version && alive_.runs[at(version.pass)] != 0)
        draft_.diagnostics->error("in-place-output",
                                  "output `" + target.name + "` is `" + target.endpoint + "`, but `" +
                                      draft_.passes[at(version.pass)].name() + "` overwrites it within the frame",
                                  target.where, "ask for what that pass makes of it, or write into a copy");
  }

  static Access normal(Access access, bool buffer) {
    return buffer && access == Access::sampled ? Access::storage_read : access;
  }

  /// The members behind a version as `pass` sees them; `declared` gives the access where the pass declares one.
  template <class Declared>
  std::vector<BoundMember> bind_members(int version, bool history, Declared declared) {
    std::vector<BoundMember> bound;
    const int root = draft_.versions[at(version)].root;
    const auto& members = draft_.versions[at(root)].info.members;
    const auto& resources = history ? previous_[at(root)] : current_[at(root)];
    bound.reserve(members.size());
    for (std::size_t m = 0; m < members.size(); ++m) {
      const bool buffer = std::holds_alternative<BufferDesc>(members[m].desc);
      const std::optional<Access> access = declared(members[m].name);
      bound.push_back({.name = members[m].name,
                       .resource = m < resources.size() ? resources[m] : none,
                       .access = normal(access.value_or(Access::sampled), buffer),
                       .declared = access.has_value()});
    }
    return bound;
  }

  BoundPort bind_input(const DraftPass& pass, const InputDecl& input) {
    BoundPort port{.name = input.name, .type = input.type, .is_input = true};
    const Wire* wire = pass.wire(input.name);
    if (wire == nullptr || wire->version == none) return port;
    const Version& version = draft_.versions[at(wire->version)];
    port.connected = true;
    port.history = wire->history();
    port.absent = version.info.absent;
    if (input.type == "*") port.type = version.info.type;
    if (port.absent) return port;
    port.bundle = (port.history ? previous_bundle_ : bundle_)[at(version.root)];
    port.members = bind_members(wire->version, port.history, [&](std::string_view member) -> std::optional<Access> {
      for (const auto& read : input.reads)
        if (read.member == member) return read.access;
      if (input.reads_all) return Access::sampled;
      return std::nullopt;
    });
    for (const auto& read : input.reads)  // what the producer does not make at all
      if (std::none_of(port.members.begin(), port.members.end(),
                       [&](const BoundMember& member) { return member.name == read.member; }))
        port.members.push_back({.name = read.member, .access = read.access});
    return port;
  }

  BoundPort bind_output(const DraftPass& pass, std::size_t index) {
    const OutputDecl& output = pass.ports.outputs[index];
    BoundPort port{.name = output.name, .type = output.type, .connected = true};
    const int version = pass.versions[index];
    port.absent = draft_.versions[at(version)].info.absent;
    if (port.absent) return port;
    const bool own = !output.forwards;
    port.bundle = bundle_[at(draft_.versions[at(version)].root)];
    port.members = bind_members(version, false, [&](std::string_view member) -> std::optional<Access> {
      for (const auto& decl : output.members)
        if (own && decl.name == member) return decl.access;
      const InputDecl* input = output.in_place ? pass.input(*output.in_place) : nullptr;
      if (input != nullptr)
        for (const auto& read : input->reads)
          if (read.member == member && writes(read.access)) return read.access;
      return std::nullopt;
    });
    return port;
  }

  /// "scratch" or "persistent", whose resources start at `resource`.
  static void bind_state(const char* name, const std::vector<MemberDecl>& decls, const int* resource,
                         CompiledPass& out) {
    if (decls.empty()) return;
    BoundPort port{.name = name, .connected = true};
    for (const auto& decl : decls)
      port.members.push_back({.name = decl.name, .resource = *resource++, .access = decl.access});
    out.bound.push_back(std::move(port));
  }

  void bind_pass(DraftPass& pass, int index, CompiledPass& out) {
    out.bound.reserve(pass.ports.inputs.size() + pass.ports.outputs.size() + 2);
    for (const auto& input : pass.ports.inputs) out.bound.push_back(bind_input(pass, input));
    for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i) out.bound.push_back(bind_output(pass, i));
    if (position_[at(index)] == none) return;
    const int* state = state_[at(index)].data();
    bind_state("scratch", pass.ports.scratches, state, out);
    bind_state("persistent", pass.ports.persistents, state + pass.ports.scratches.size(), out);
  }

  Draft& draft_;
  const Liveness& alive_;
  CompiledGraph& graph_;
  std::vector<int> position_;              // by pass, in graph_.order
  std::vector<std::vector<int>> state_;    // by pass: resources of scratches, then persistents
  std::vector<std::vector<int>> current_;  // by root version and member: resource
  std::vector<std::vector<int>> previous_;
  std::vector<int> bundle_, previous_bundle_;  // by root version
  int end_ = 0;
};

}  // namespace

void make_resources(Draft& draft, const Liveness& alive, CompiledGraph& graph) {
  ResourceMaker(draft, alive, graph).run();
}

}  // namespace loom::graph
