#pragma once
// The graph and the plan for people, editors and other programs. All JSON carries "version": 1.
#include <string>

#include "graph/compile/compile.h"
#include "loom/export.h"
#include "loom/facts.h"
#include "loom/registry.h"

namespace loom::graph {

/// Graphviz source: passes as nodes with their ports, wires labelled by what they carry, dashed where they bring the
/// last frame; passes that do not run in grey with the reason.
LOOM_API std::string to_dot(const CompiledGraph& graph);
/// `loom graph --format json`: passes with their ports, wires, outputs, what was left out.
LOOM_API std::string to_json(const CompiledGraph& graph);
/// `loom plan --json`: passes in the order they run, resources with lifetime (positions in that order) and slot, facts,
/// decisions, what was left out, memory with and without aliasing.
LOOM_API std::string plan_json(const CompiledGraph& graph, const SceneFacts& facts);
/// JSON Schema (draft-07) of pipeline files, from the registered types and their parameter declarations.
LOOM_API std::string pipeline_schema(const Registry& registry);

}  // namespace loom::graph
