#include "graph/compile/draft.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace loom::graph {

const Wire* DraftPass::wire(std::string_view port) const {
  const auto it = std::find_if(wires.begin(), wires.end(), [&](const Wire& w) { return w.entry->input == port; });
  return it == wires.end() ? nullptr : &*it;
}

const InputDecl* DraftPass::input(std::string_view port) const {
  const auto it = std::find_if(ports.inputs.begin(), ports.inputs.end(), [&](const auto& p) { return p.name == port; });
  return it == ports.inputs.end() ? nullptr : &*it;
}

int DraftPass::output(std::string_view port) const {
  for (std::size_t i = 0; i < ports.outputs.size(); ++i)
    if (ports.outputs[i].name == port) return static_cast<int>(i);
  return none;
}

bool Draft::rule(std::string_view name) const {
  const auto& disabled = options->disabled_rules;
  return options->prune && std::find(disabled.begin(), disabled.end(), name) == disabled.end();
}

const DraftPass* Draft::pass(std::string_view name) const {
  const auto it = pass_index.find(name);
  return it == pass_index.end() ? nullptr : &passes[static_cast<std::size_t>(it->second)];
}

std::vector<std::string> Draft::pass_names() const {
  std::vector<std::string> names;
  for (const auto& pass : passes) names.push_back(pass.name());
  return names;
}

std::string Draft::version_name(int index) const {
  const Version& version = versions[static_cast<std::size_t>(index)];
  if (version.external != none) return "inputs." + externals[static_cast<std::size_t>(version.external)].entry->name;
  const DraftPass& pass = passes[static_cast<std::size_t>(version.pass)];
  return pass.name() + '.' + pass.ports.outputs[static_cast<std::size_t>(version.output)].name;
}

bool Draft::takes_in_place(const DraftPass& pass, std::string_view input) const {
  return std::any_of(pass.ports.outputs.begin(), pass.ports.outputs.end(),
                     [&](const OutputDecl& output) { return output.in_place && *output.in_place == input; });
}

std::string carries(const BundleInfo& info) {
  std::string text = info.type;
  for (std::size_t i = 0; i < info.members.size(); ++i) text += (i == 0 ? " (" : ", ") + info.members[i].name;
  if (!info.members.empty()) text += ')';
  if (info.absent) text += " (nothing: " + *info.absent + ')';
  return text;
}

}  // namespace loom::graph
