// The graph as Graphviz source.
#include <string>
#include <string_view>

#include "graph/compile/export.h"

namespace loom::graph {
namespace {

constexpr std::string_view running_colour = "#f4f1e8";
constexpr std::string_view idle_colour = "#f0f0f0";
constexpr std::string_view idle_text = "#999999";

/// For HTML-like labels and attribute strings alike.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\\')
      out += "&#92;";
    else
      out += c;
  }
  return out;
}

std::string why_idle(const CompiledGraph& graph, const std::string& pass) {
  for (const auto& pruned : graph.pruned)
    if (pruned.what == pass) return pruned.why;
  return {};
}

/// One column of port cells; `side` is "in" or "out".
std::string port_column(const CompiledPass& pass, bool inputs) {
  std::string rows;
  for (const auto& port : pass.bound) {
    if (port.is_input != inputs || port.name == "scratch" || port.name == "persistent") continue;
    rows += "<tr><td port=\"" + std::string(inputs ? "in_" : "out_") + escaped(port.name) + "\" align=\"" +
            (inputs ? "left" : "right") + "\">" + escaped(port.name) + (port.absent ? " ∅" : "") + "</td></tr>";
  }
  if (rows.empty()) return "<td></td>";
  return R"(<td><table border="0" cellborder="0" cellspacing="0">)" + rows + "</table></td>";
}

std::string node(const CompiledGraph& graph, const CompiledPass& pass) {
  const std::string why = pass.runs ? "" : why_idle(graph, pass.name);
  const std::string colour(pass.runs ? running_colour : idle_colour);
  std::string text = "  \"" + pass.name + "\" [tooltip=\"" + escaped(pass.runs ? pass.type : why) + '"';
  if (!pass.runs) text += ", fontcolor=\"" + std::string(idle_text) + '"';
  text += R"(, label=<<table border="1" cellborder="0" cellspacing="0" color=")" +
          std::string(pass.runs ? "#444444" : idle_text) + "\" bgcolor=\"" + colour + "\">";
  text += "<tr><td colspan=\"2\"><b>" + escaped(pass.name) + "</b><br/><font point-size=\"9\">" + escaped(pass.type) +
          "</font></td></tr>";
  if (!why.empty()) text += R"(<tr><td colspan="2"><font point-size="8"><i>)" + escaped(why) + "</i></font></td></tr>";
  text += "<tr>" + port_column(pass, true) + port_column(pass, false) + "</tr></table>>];\n";
  return text;
}

std::string wire(const CompiledGraph& graph, const Edge& edge) {
  const CompiledPass* to = graph.pass(edge.to_pass);
  const bool grey = to != nullptr && !to->runs;
  const std::string from = edge.from_pass == "inputs" ? "\"inputs." + edge.from_port + '"'
                                                      : '"' + edge.from_pass + "\":\"out_" + edge.from_port + "\":e";
  std::string text = "  " + from + " -> \"" + edge.to_pass + "\":\"in_" + edge.to_port + "\":w [label=\"" +
                     escaped(edge.type) + (edge.history ? " @prev" : "") + '"';
  if (edge.history) text += ", style=dashed, constraint=false";
  if (grey) text += ", color=\"" + std::string(idle_text) + "\", fontcolor=\"" + std::string(idle_text) + '"';
  return text + "];\n";
}

std::string output(const GraphOutput& output) {
  const std::string name = "\"outputs." + output.name + '"';
  std::string text = "  " + name + R"( [shape=box, style="rounded,filled", fillcolor="#dfeaf4", label=")" +
                     escaped(output.name) + "\"";
  if (output.absent)
    text += ", fontcolor=\"" + std::string(idle_text) + "\", tooltip=\"" + escaped(*output.absent) + '"';
  text += "];\n";
  if (output.endpoint.empty()) return text;
  const auto dot = output.endpoint.find('.');
  const auto end = output.endpoint.find('.', dot + 1);
  const std::string pass = output.endpoint.substr(0, dot);
  const std::string port = output.endpoint.substr(dot + 1, end == std::string::npos ? end : end - dot - 1);
  text += "  " + (pass == "inputs" ? "\"inputs." + port + '"' : '"' + pass + "\":\"out_" + port + "\":e") + " -> " +
          name + ";\n";
  return text;
}

}  // namespace

std::string to_dot(const CompiledGraph& graph) {
  std::string text = "digraph pipeline {\n  rankdir=LR;\n  label=\"" + escaped(graph.name) +
                     "\";\n  labelloc=t;\n  fontname=\"Helvetica\";\n"
                     "  node [shape=plain, fontname=\"Helvetica\", fontsize=11];\n"
                     "  edge [fontname=\"Helvetica\", fontsize=8, arrowsize=0.6, color=\"#444444\"];\n";
  for (const auto& pass : graph.passes) text += node(graph, pass);
  std::string declared;
  for (const auto& edge : graph.edges) {
    const std::string name = "\"inputs." + edge.from_port + '"';
    if (edge.from_pass != "inputs" || declared.find(name) != std::string::npos) continue;
    declared += "  " + name + " [shape=box, style=\"rounded,filled\", fillcolor=\"#e8f4df\"];\n";
  }
  text += declared;
  for (const auto& edge : graph.edges) text += wire(graph, edge);
  for (const auto& item : graph.outputs) text += output(item);
  return text + "}\n";
}

}  // namespace loom::graph
