#include "cli/svg.h"

#include <memory>

#include <graphviz/gvc.h>

#include "loom/diagnostic.h"

namespace loom::cli {
namespace {

struct ContextDeleter {
  void operator()(GVC_t* context) const { gvFreeContext(context); }
};
struct GraphDeleter {
  void operator()(Agraph_t* graph) const { agclose(graph); }
};

}  // namespace

std::string svg_from_dot(const std::string& dot) {
  const std::unique_ptr<GVC_t, ContextDeleter> context(gvContext());
  const std::unique_ptr<Agraph_t, GraphDeleter> graph(agmemread(dot.c_str()));
  if (!context || !graph) throw Error("Graphviz cannot read the graph; `--format dot` shows what it was given");
  if (gvLayout(context.get(), graph.get(), "dot") != 0)
    throw Error("Graphviz cannot lay out the graph; is its `dot` layout installed (Debian: libgvc6)?");
  char* data = nullptr;
  unsigned int length = 0;
  const int failed = gvRenderData(context.get(), graph.get(), "svg", &data, &length);
  std::string svg;
  if (failed == 0) svg.assign(data, length);
  if (data != nullptr) gvFreeRenderData(data);
  gvFreeLayout(context.get(), graph.get());
  if (failed != 0) throw Error("Graphviz cannot draw the graph as SVG");
  return svg;
}

}  // namespace loom::cli
