#include "graph/run/keep.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
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
  ++frames_;
}

void KeepTracker::forget() {
  for (State& state : states_) {
    state.fingerprint.reset();
    state.made = false;
  }
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

void KeepTracker::ran(int pass) {
  State& state = states_[static_cast<std::size_t>(pass)];
  ++state.runs;
  state.made = true;
}

bool KeepTracker::kept(const CompiledPass& pass) const {
  return pass.ports.keeps_outputs && states_[static_cast<std::size_t>(&pass - graph_.passes.data())].made;
}

std::uint64_t KeepTracker::revision(int producer) const {
  if (producer == none) return frames_;
  const auto at = static_cast<std::size_t>(producer);
  if (graph_.passes[at].runs) return states_[at].runs;
  // Counters only grow: their sum stays where all of them do.
  return std::accumulate(upstream_[at].begin(), upstream_[at].end(), std::uint64_t{0},
                         [&](std::uint64_t sum, int further) { return sum + revision(further); });
}

std::uint64_t KeepTracker::revision(const CompiledPass& pass, std::string_view input) const {
  for (const Edge& edge : graph_.edges) {
    if (edge.to_pass != pass.name || edge.to_port != input) continue;
    const auto from = std::find_if(graph_.passes.begin(), graph_.passes.end(),
                                   [&](const CompiledPass& other) { return other.name == edge.from_pass; });
    const bool always = from == graph_.passes.end() || edge.history;
    return revision(always ? none : static_cast<int>(from - graph_.passes.begin()));
  }
  return 0;
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
