// Stage 2: look up types, set parameters, find what each wire is attached to.
#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "graph/compile/draft.h"

namespace loom::graph {
namespace {

std::string brought_by(const PassType& type) { return type.plugin.empty() ? "" : " (from `" + type.plugin + "`)"; }

/// Runs code of a plugin; what it throws becomes a diagnostic at the pass.
template <class Call>
bool guarded(Draft& draft, const DraftPass& pass, const std::string& doing, Call call) {
  const auto report = [&](const std::string& what) {
    draft.diagnostics->error(
        "pass-failed",
        "`" + pass.name() + "`: " + pass.type->name + brought_by(*pass.type) + " threw while " + doing + ": " + what,
        pass.entry->where);
    return false;
  };
  try {
    call();
    return true;
  } catch (const std::exception& error) {
    return report(error.what());
  } catch (...) {
    return report("something that is no std::exception");
  }
}

void find_type(Draft& draft, DraftPass& pass) {
  if (pass.entry->type == nullptr) return;
  const std::string& name = pass.entry->type->string;
  pass.type = draft.registry->pass(name);
  if (pass.type != nullptr) return;
  std::vector<std::string> names;
  for (const auto& type : draft.registry->passes()) names.push_back(type.name);
  std::string hint = name_hint(name, names);
  if (hint.empty()) hint = "`loom passes` lists the types there are; --plugins adds more";
  draft.diagnostics->error("unknown-type", "there is no pass type `" + name + "` (pass `" + pass.name() + "`)",
                           pass.entry->type->where, std::move(hint));
}

void check_keys(Draft& draft, const DraftPass& pass) {
  std::vector<std::string> known(std::begin(pass_keys), std::end(pass_keys));
  const auto own = pass.pass->own_keys();
  known.insert(known.end(), own.begin(), own.end());
  for (const auto& member : pass.entry->node.members)
    if (std::find(known.begin(), known.end(), member.key) == known.end())
      draft.diagnostics->error("unknown-key",
                               "pass `" + pass.name() + "` (" + pass.type->name + ") has no key `" + member.key + '`',
                               member.key_where, name_hint(member.key, known));
}

void make(Draft& draft, DraftPass& pass) {
  find_type(draft, pass);
  if (pass.type == nullptr) return;
  std::unique_ptr<Pass> made;
  if (!guarded(draft, pass, "it was made", [&] { made = pass.type->create(); })) return;
  if (made == nullptr) {
    draft.diagnostics->error("pass-failed", "`" + pass.name() + "`: " + pass.type->name + " made nothing",
                             pass.entry->where);
    return;
  }
  pass.pass = std::move(made);
  check_keys(draft, pass);
  if (!guarded(draft, pass, "it read its keys", [&] { pass.pass->configure(pass.entry->node, *draft.diagnostics); }) ||
      !guarded(draft, pass, "it declared its parameters", [&] { pass.pass->params(pass.params); })) {
    pass.pass.reset();
    return;
  }
  for (const auto* param : pass.entry->params) {
    if (pass.params.find(param->key) != nullptr) {
      pass.params.set(param->key, param->value, pass.name(), *draft.diagnostics);
      continue;
    }
    // A name that is wrong is reported where the name stands.
    json::Node at_key;
    at_key.where = param->key_where;
    pass.params.set(param->key, at_key, pass.name(), *draft.diagnostics);
  }
}

void override_params(Draft& draft) {
  for (const auto& setting : draft.options->overrides) {
    const auto found = draft.pass_index.find(setting.pass);
    if (found == draft.pass_index.end()) {
      draft.diagnostics->error("unknown-pass", "the pipeline has no pass `" + setting.pass + '`',
                               {"--set " + setting.pass + '.' + setting.param + '=' + setting.value, 0, 0, {}},
                               name_hint(setting.pass, draft.pass_names()));
      continue;
    }
    DraftPass& pass = draft.passes[static_cast<std::size_t>(found->second)];
    if (pass.usable()) pass.params.set_text(setting.param, setting.value, setting.pass, *draft.diagnostics);
  }
}

void find_source(Draft& draft, const DraftPass& pass, Wire& wire) {
  const Endpoint& from = wire.entry->from;
  const std::string input = "`" + pass.name() + '.' + wire.entry->input + '`';
  if (from.external()) {
    for (std::size_t i = 0; i < draft.externals.size(); ++i)
      if (draft.externals[i].entry->name == from.port) wire.external = static_cast<int>(i);
    if (wire.external != none) return;
    std::vector<std::string> names;
    for (const auto& external : draft.externals) names.push_back(external.entry->name);
    std::string hint = name_hint(from.port, names);
    if (hint.empty()) hint = R"(declare it: "inputs": { ")" + from.port + R"(": { "type": "Image" } })";
    draft.diagnostics->error("unknown-input",
                             input + " is wired to `inputs." + from.port + "`, which the pipeline does not declare",
                             wire.entry->where, std::move(hint));
    return;
  }
  const auto found = draft.pass_index.find(from.pass);
  if (found == draft.pass_index.end()) {
    draft.diagnostics->error(
        "unknown-pass", input + " is wired to `" + wire.entry->text + "`, but there is no pass `" + from.pass + '`',
        wire.entry->where, name_hint(from.pass, draft.pass_names()));
    return;
  }
  if (draft.passes[static_cast<std::size_t>(found->second)].entry == pass.entry && !from.history) {
    draft.diagnostics->error("self-wire", input + " is wired to the pass's own output `" + wire.entry->text + '`',
                             wire.entry->where, "use `" + wire.entry->text + "@prev` for its value of the last frame");
    return;
  }
  wire.from_pass = found->second;
}

void declare_externals(Draft& draft) {
  for (const auto& entry : draft.document->inputs) {
    External external;
    external.entry = &entry;
    external.info.type = entry.type;
    const BundleType* type = draft.registry->bundle(entry.type);
    if (type == nullptr && !entry.type.empty()) {
      std::vector<std::string> names;
      for (const auto& bundle : draft.registry->bundles()) names.push_back(bundle.name);
      draft.diagnostics->error("unknown-bundle", "there is no bundle type `" + entry.type + '`', entry.type_where,
                               name_hint(entry.type, names));
    }
    if (!entry.format.empty()) {
      const auto format = format_from(entry.format);
      if (!format)
        draft.diagnostics->error("unknown-format", "there is no texture format `" + entry.format + '`',
                                 entry.format_where, "for example rgba16f, rgba8, r32f, depth32f");
      else if (type != nullptr && !type->members.empty() && type->members.front().kind == MemberKind::texture)
        external.info.members.push_back(
            {.name = type->members.front().name,
             .desc = TextureDesc::image(
                 entry.width > 0 ? glm::ivec2(entry.width, entry.height) : draft.options->frame_size, *format)});
    }
    const auto supplied = draft.options->external_inputs.find(entry.name);
    if (supplied != draft.options->external_inputs.end()) {
      if (supplied->second.type != entry.type)
        draft.diagnostics->error("input-mismatch",
                                 "`inputs." + entry.name + "` is declared as " + entry.type +
                                     ", but the program supplies " + carries(supplied->second),
                                 entry.where);
      for (const auto& declared : external.info.members)
        for (const auto& given : supplied->second.members) {
          const auto* texture = std::get_if<TextureDesc>(&given.desc);
          if (given.name == declared.name &&
              (texture == nullptr || texture->format != std::get<TextureDesc>(declared.desc).format))
            draft.diagnostics->error("input-mismatch",
                                     "`inputs." + entry.name + '.' + given.name + "` is declared as " + entry.format +
                                         ", but the program supplies " +
                                         (texture == nullptr ? "a buffer" : to_string(*texture)),
                                     entry.where);
        }
      external.info = supplied->second;
    }
    draft.externals.push_back(std::move(external));
  }
}

}  // namespace

void resolve(Draft& draft) {
  const auto& entries = draft.document->passes;
  draft.passes.reserve(entries.size());
  draft.pass_index.reserve(entries.size());
  for (const auto& entry : entries) {
    draft.pass_index.emplace(entry.name, static_cast<int>(draft.passes.size()));
    draft.passes.emplace_back().entry = &entry;
  }
  declare_externals(draft);
  for (auto& pass : draft.passes) {
    make(draft, pass);
    pass.wires.reserve(pass.entry->wires.size());
    for (const auto& entry : pass.entry->wires) {
      Wire wire{.entry = &entry};
      find_source(draft, pass, wire);
      pass.wires.push_back(wire);
    }
  }
  override_params(draft);
}

}  // namespace loom::graph
