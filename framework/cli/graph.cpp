// loom graph: a pipeline as a drawing.
#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/dot.h"
#include "cli/json_out.h"
#include "core/image_io.h"
#include "graph/compile/compile.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::string pipeline, scene, format = "svg", out;
};

Json graph_json(const graph::CompiledGraph& graph) {
  Json document = versioned();
  document["name"] = graph.name;
  document["summary"] = graph.summary;
  Json& passes = document["passes"] = Json::array();
  for (const graph::CompiledPass& pass : graph.passes) {
    passes.push_back({{"name", pass.name}, {"type", pass.type}, {"runs", pass.runs}});
  }
  Json& edges = document["edges"] = Json::array();
  for (const graph::Edge& e : graph.edges) {
    edges.push_back({{"from", e.from_pass + "." + e.from_port},
                     {"to", e.to_pass + "." + e.to_port},
                     {"type", e.type},
                     {"history", e.history}});
  }
  Json& outputs = document["outputs"] = Json::array();
  for (const graph::GraphOutput& o : graph.outputs) {
    outputs.push_back({{"name", o.name}, {"endpoint", o.endpoint}, {"quantity", o.quantity}});
  }
  Json& pruned = document["pruned"] = Json::array();
  for (const graph::Pruned& p : graph.pruned) pruned.push_back({{"what", p.what}, {"why", p.why}});
  return document;
}

void run(const Arguments& arguments, const Session& session) {
  const Registry registry = load_registry(session);
  const LoadedScene scene = load_scene(arguments.scene);
  const graph::CompiledGraph graph = compile(find_pipeline(arguments.pipeline), registry, scene.facts, {});
  std::string text;
  if (arguments.format == "json") {
    text = text_of(graph_json(graph));
  } else {
    text = dot_text(graph);
    if (arguments.format == "svg") text = svg_of(text);
  }
  if (arguments.out.empty()) {
    std::fwrite(text.data(), 1, text.size(), stdout);
  } else {
    write_file_atomic(arguments.out, std::as_bytes(std::span(text)));
  }
}

}  // namespace

void add_graph(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("graph", "Draw a pipeline: passes, wires and what they carry");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("pipeline", arguments->pipeline, "A pipeline file, or the name of a shipped one")->required();
  command->add_option("--format", arguments->format, "svg, dot or json")
      ->check(CLI::IsMember({"svg", "dot", "json"}))
      ->capture_default_str();
  command->add_option("--scene", arguments->scene, "Draw what this scene requires; default: the built-in one");
  command->add_option("-o,--out", arguments->out, "Write to this file; default: stdout");
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
