#pragma once
// Stage 6 in four steps: what is alive, which resources that needs, which storage they share, which barriers order
// them.
#include <string>
#include <vector>

#include "graph/compile/draft.h"

namespace loom::graph {

/// Indexed as Draft::passes and Draft::versions; members as BundleInfo::members of the root version.
struct Liveness {
  std::vector<char> runs;                  ///< by pass
  std::vector<std::vector<char>> members;  ///< by version; only roots are filled
  std::vector<std::vector<char>> history;  ///< by version: members whose last frame somebody reads; only roots
  std::vector<char> overwritten;           ///< by version, only roots: a pass that runs changes it in place
};

/// Backwards from the targets and from passes with side effects.
Liveness find_alive(const Draft& draft);
/// Says what is not alive, and why.
void explain_pruned(const Draft& draft, const Liveness& alive, CompiledGraph& graph);

/// Fills order, resources, bundles, outputs and the passes' bound ports.
void make_resources(Draft& draft, const Liveness& alive, CompiledGraph& graph);
/// Gives every resource a slot, shared where descriptors are equal and lifetimes do not meet.
void assign_slots(CompiledGraph& graph, bool alias);
/// Sets CompiledPass::barriers.
void place_barriers(CompiledGraph& graph);

}  // namespace loom::graph
