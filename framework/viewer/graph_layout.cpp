#include "viewer/graph_layout.h"

#include <cstddef>
#include <map>
#include <memory>

#include <graphviz/gvc.h>

#include "loom/diagnostic.h"

namespace loom::viewer {
namespace {

constexpr double points_per_inch = 72;

struct ContextDeleter {
  void operator()(GVC_t* context) const { gvFreeContext(context); }
};
struct GraphDeleter {
  void operator()(Agraph_t* graph) const { agclose(graph); }
};

/// cgraph's interface takes char* where it only reads.
char* text(const char* literal) { return const_cast<char*>(literal); }
char* text(std::string& string) { return string.data(); }

class Layout {
 public:
  explicit Layout(const graph::CompiledGraph& graph) : graph_(graph), dot_(agopen(text("g"), Agdirected, nullptr)) {
    if (!context_ || !dot_) throw Error("Graphviz cannot be started");
    declare(AGRAPH, "rankdir", "LR");
    declare(AGRAPH, "nodesep", "0.3");
    declare(AGRAPH, "ranksep", "0.4");
    declare(AGNODE, "shape", "box");
    declare(AGNODE, "fixedsize", "true");
    declare(AGNODE, "label", "");
    declare(AGNODE, "width", "1");
    declare(AGNODE, "height", "1");
    declare(AGEDGE, "constraint", "true");
  }

  GraphLayout run(glm::vec2 node, glm::vec2 output) {
    for (const graph::CompiledPass& pass : graph_.passes) add_node(pass.name, node);
    for (const graph::Edge& edge : graph_.edges)
      if (edge.from_pass == "inputs") add_node("inputs." + edge.from_port, output);
    for (std::size_t i = 0; i < graph_.edges.size(); ++i) {
      const graph::Edge& edge = graph_.edges[i];
      const std::string from = edge.from_pass == "inputs" ? "inputs." + edge.from_port : edge.from_pass;
      add_edge(from, edge.to_pass, {.edge = static_cast<int>(i), .points = {}}, edge.history);
    }
    for (std::size_t i = 0; i < graph_.outputs.size(); ++i) {
      const std::string& endpoint = graph_.outputs[i].endpoint;
      const std::string from = endpoint.substr(0, endpoint.find('.'));
      if (!nodes_.contains(from)) continue;
      const std::string name = "outputs." + graph_.outputs[i].name;
      add_node(name, output);
      add_edge(from, name, {.output = static_cast<int>(i), .points = {}}, false);
    }
    if (gvLayout(context_.get(), dot_.get(), "dot") != 0) throw Error("Graphviz cannot lay out the graph");
    GraphLayout result = read();
    gvFreeLayout(context_.get(), dot_.get());
    return result;
  }

 private:
  void declare(int kind, const char* name, const char* value) { agattr(dot_.get(), kind, text(name), text(value)); }

  void add_node(std::string name, glm::vec2 size) {
    if (nodes_.contains(name)) return;
    Agnode_t* node = agnode(dot_.get(), text(name), 1);
    std::string width = std::to_string(size.x / points_per_inch), height = std::to_string(size.y / points_per_inch);
    agset(node, text("width"), text(width));
    agset(node, text("height"), text(height));
    nodes_.emplace(std::move(name), node);
  }

  void add_edge(const std::string& from, const std::string& to, WirePlace wire, bool history) {
    const auto tail = nodes_.find(from), head = nodes_.find(to);
    if (tail == nodes_.end() || head == nodes_.end()) return;
    Agedge_t* edge = agedge(dot_.get(), tail->second, head->second, nullptr, 1);
    // What comes from the last frame shall not push its producer to the left.
    if (history) agset(edge, text("constraint"), text("false"));
    edges_.emplace_back(edge, std::move(wire));
  }

  [[nodiscard]] GraphLayout read() const {
    GraphLayout result;
    const boxf box = GD_bb(dot_.get());
    result.size = {box.UR.x, box.UR.y};
    const auto place = [&](pointf p) { return glm::vec2(p.x, box.UR.y - p.y); };
    for (const auto& [name, node] : nodes_)
      result.nodes.push_back(
          {.pass = name,
           .centre = place(ND_coord(node)),
           .size = glm::vec2(ND_width(node), ND_height(node)) * static_cast<float>(points_per_inch)});
    for (const auto& [edge, wire] : edges_) {
      WirePlace placed = wire;
      if (const splines* line = ED_spl(edge); line != nullptr && line->size > 0) {
        const bezier& curve = line->list[0];
        for (std::size_t i = 0; i < static_cast<std::size_t>(curve.size); ++i)
          placed.points.push_back(place(curve.list[i]));
        if (curve.eflag != 0) placed.points.insert(placed.points.end(), 3, place(curve.ep));
      }
      result.wires.push_back(std::move(placed));
    }
    return result;
  }

  const graph::CompiledGraph& graph_;
  std::unique_ptr<GVC_t, ContextDeleter> context_{gvContext()};
  std::unique_ptr<Agraph_t, GraphDeleter> dot_;
  std::map<std::string, Agnode_t*> nodes_;
  std::vector<std::pair<Agedge_t*, WirePlace>> edges_;
};

}  // namespace

GraphLayout lay_out(const graph::CompiledGraph& graph, glm::vec2 node, glm::vec2 output) {
  return Layout(graph).run(node, output);
}

}  // namespace loom::viewer
