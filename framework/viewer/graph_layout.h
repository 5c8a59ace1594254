#pragma once
// Where the nodes and wires of a pipeline go on a plane: Graphviz's `dot`, from left to right.
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "graph/compile/compile.h"

namespace loom::viewer {

struct NodePlace {
  std::string pass;  ///< or "inputs.x", "outputs.x"
  glm::vec2 centre{0}, size{0};
};

/// A cubic Bézier spline: 1 + 3n points.
struct WirePlace {
  int edge = -1;  ///< into CompiledGraph::edges, −1: to an output
  int output = -1;
  std::vector<glm::vec2> points;
};

struct GraphLayout {
  glm::vec2 size{0};
  std::vector<NodePlace> nodes;
  std::vector<WirePlace> wires;
};

/// `node` and `output`: the size of a pass's and an output's box, in the unit of the result. y points down. Throws
/// Error where Graphviz fails.
GraphLayout lay_out(const graph::CompiledGraph& graph, glm::vec2 node, glm::vec2 output);

}  // namespace loom::viewer
