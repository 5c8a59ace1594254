#include "graph/run/keep.h"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>

namespace loom::graph {

KeepTracker::KeepTracker(const CompiledGraph& graph)
    : graph_(graph), states_(graph.passes.size()), upstream_(graph.passes.size()) {
  std::unordered_map<std::string, int> index;
  for (std::size_t i = 0; i < graph.passes.size(); ++i) index[graph.passes[i].name] = static_cast<int>(i);
  for (const Edge& edge : graph.edges) {
    const auto from = index.find(edge.from_pass);
    const auto to = index.find(edge.to_pass);
    if (to == index.end()) continue;
    const bool always = from == index.end() || edge.history;
    upstream_[static_cast<std::size_t>(to->second)].push_back(always ? none : from->second);
  }
}

void KeepTracker::begin_frame() {
  for (State& state : states_) state.changed = true;
}

void KeepTracker::forget() {
  for (State& state : states_) state.fingerprint.reset();
}

bool KeepTracker::upstream_changed(int pass) const {
  const auto& from = upstream_[static_cast<std::size_t>(pass)];
  return std::any_of(from.begin(), from.end(), [&](int producer) {
    if (producer == none) return true;
    // One that does not run forwards its inputs, or carries nothing.
    if (!graph_.passes[static_cast<std::size_t>(producer)].runs) return upstream_changed(producer);
    return states_[static_cast<std::size_t>(producer)].changed;
  });
}

bool KeepTracker::may_keep(int pass, const Frame& frame) {
  const CompiledPass& compiled = graph_.passes[static_cast<std::size_t>(pass)];
  State& state = states_[static_cast<std::size_t>(pass)];
  if (!compiled.ports.keeps_outputs) return false;
  const Fingerprint fingerprint = compiled.pass->fingerprint(frame);
  std::vector<ParamValue> params;
  for (const ParamDecl& decl : compiled.params.all()) params.push_back(Params::value_of(decl));
  const bool same =
      fingerprint && state.fingerprint == fingerprint && state.params == params && !upstream_changed(pass);
  state.fingerprint = fingerprint;
  state.params = std::move(params);
  state.changed = !same;
  return same;
}

}  // namespace loom::graph
