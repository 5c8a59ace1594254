#pragma once
// A compiled graph as a drawing.
#include <string>

#include "graph/compile/compile.h"

namespace loom::cli {

/// Graphviz text: a box a pass with its ports, an arrow a wire labelled with what it carries. History wires are dashed,
/// passes that do not run are grey and say why in their tooltip.
std::string dot_text(const graph::CompiledGraph& graph);
/// Laid out by Graphviz. Throws Error where that fails.
std::string svg_of(const std::string& dot);

}  // namespace loom::cli
