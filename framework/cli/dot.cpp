#include "cli/dot.h"

#include <cgraph.h>
#include <gvc.h>

#include <cstdint>
#include <memory>
#include <string_view>

#include "loom/diagnostic.h"

namespace loom::cli {
namespace {

/// For a quoted string; `record` also escapes what structures a record label.
std::string escaped(std::string_view text, bool record = false) {
  std::string result;
  for (const char c : text) {
    const bool special =
        c == '"' || c == '\\' || (record && std::string_view("{}|<> ").find(c) != std::string_view::npos);
    if (special) result += '\\';
    result += c;
  }
  return result;
}

std::string quoted(std::string_view text) { return '"' + escaped(text) + '"'; }

/// "{<i_a> a|<i_b> b}" of the wired ports on one side of a pass.
std::string ports_label(const graph::CompiledPass& pass, bool inputs) {
  std::string label;
  for (const graph::BoundPort& port : pass.bound) {
    if (port.is_input != inputs || port.name == "scratch" || port.name == "persistent") continue;
    if (!label.empty()) label += '|';
    label += std::string(inputs ? "<i_" : "<o_") + port.name + "> " + escaped(port.name, true);
  }
  return '{' + label + '}';
}

std::string why_pruned(const graph::CompiledGraph& graph, const std::string& pass) {
  for (const graph::Pruned& pruned : graph.pruned) {
    if (pruned.what == pass) return pruned.why;
  }
  return {};
}

std::string pass_node(const graph::CompiledGraph& graph, const graph::CompiledPass& pass) {
  const std::string label = '{' + ports_label(pass, true) + '|' + escaped(pass.name, true) + "\\n" +
                            escaped(pass.type, true) + '|' + ports_label(pass, false) + '}';
  std::string node = "  " + quoted(pass.name) + " [label=\"" + label +
                     "\", tooltip=" + quoted(pass.runs ? pass.type : "not run: " + why_pruned(graph, pass.name));
  if (!pass.runs) node += ", color=gray60, fontcolor=gray60, style=dashed";
  return node + "];\n";
}

/// "pass":"o_port" of an endpoint "pass.port[.member]".
std::string source_of(const std::string& endpoint) {
  const std::size_t dot = endpoint.find('.');
  const std::string port = endpoint.substr(dot + 1, endpoint.find('.', dot + 1) - dot - 1);
  return quoted(endpoint.substr(0, dot)) + ':' + quoted("o_" + port);
}

}  // namespace

std::string dot_text(const graph::CompiledGraph& graph) {
  std::string text = "digraph " + quoted(graph.name) +
                     " {\n  rankdir=LR;\n  node [shape=record, fontname=\"Helvetica\", fontsize=11];\n"
                     "  edge [fontname=\"Helvetica\", fontsize=9, color=gray30];\n";
  for (const graph::CompiledPass& pass : graph.passes) text += pass_node(graph, pass);
  for (const graph::Edge& edge : graph.edges) {
    text += "  " + quoted(edge.from_pass) + ':' + quoted("o_" + edge.from_port) + " -> " + quoted(edge.to_pass) + ':' +
            quoted("i_" + edge.to_port) + " [label=" + quoted(edge.type + (edge.history ? " @prev" : ""));
    if (edge.history) text += ", style=dashed, constraint=false";
    text += "];\n";
  }
  for (const graph::GraphOutput& output : graph.outputs) {
    const std::string node = quoted("output " + output.name);
    text += "  " + node + " [shape=plaintext, label=" + quoted(output.name) + "];\n";
    if (output.endpoint.find('.') != std::string::npos)
      text += "  " + source_of(output.endpoint) + " -> " + node + ";\n";
  }
  return text + "}\n";
}

std::string svg_of(const std::string& dot) {
  const std::unique_ptr<GVC_t, int (*)(GVC_t*)> context(gvContext(), &gvFreeContext);
  const std::unique_ptr<Agraph_t, int (*)(Agraph_t*)> graph(agmemread(dot.c_str()), &agclose);
  if (!context || !graph || gvLayout(context.get(), graph.get(), "dot") != 0) {
    throw Error("Graphviz cannot lay out the graph; --format dot gives its text");
  }
  char* data = nullptr;
  unsigned int length = 0;
  const int failed = gvRenderData(context.get(), graph.get(), "svg", &data, &length);
  const std::string svg = failed == 0 && data != nullptr ? std::string(data, length) : std::string();
  if (data != nullptr) gvFreeRenderData(data);
  gvFreeLayout(context.get(), graph.get());
  if (svg.empty()) throw Error("Graphviz cannot draw SVG; --format dot gives the text of the graph");
  return svg;
}

}  // namespace loom::cli
