// loom graph: a pipeline as a drawing.
#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/svg.h"
#include "core/image_io.h"
#include "graph/compile/compile.h"
#include "graph/compile/export.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::string pipeline, scene, surfaces, format = "svg", out;
  scene::LoadOptions load;
};

void run(const Arguments& arguments, const Session& session) {
  const Registry registry = load_registry(session);
  const LoadedScene scene = load_scene(arguments.scene, "", arguments.surfaces, arguments.load);
  const graph::CompiledGraph graph = compile(find_pipeline(arguments.pipeline), registry, scene.facts, {});
  std::string text;
  if (arguments.format == "json") {
    text = graph::to_json(graph);
  } else {
    text = graph::to_dot(graph);
    if (arguments.format == "svg") text = svg_from_dot(text);
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
  add_surfaces_option(*command, arguments->surfaces);
  command->add_option("-o,--out", arguments->out, "Write to this file; default: stdout");
  add_load_options(*command, arguments->load);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
