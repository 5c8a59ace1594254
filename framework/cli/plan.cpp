// loom plan: what runs for this scene, what was left out and why, and the memory it takes.
#include <cstdio>
#include <memory>
#include <string>
#include <variant>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "graph/compile/compile.h"
#include "graph/compile/export.h"
#include "loom/formats.h"

namespace loom::cli {
namespace {

std::string format_of(const graph::Resource& resource) {
  if (const auto* texture = std::get_if<TextureDesc>(&resource.desc)) return std::string(to_string(texture->format));
  return "buffer";
}

std::string size_of(const graph::Resource& resource) {
  const auto* texture = std::get_if<TextureDesc>(&resource.desc);
  if (texture == nullptr) return std::to_string(std::get<BufferDesc>(resource.desc).bytes);
  const std::string text = to_string(*texture);  // "rgba16f 512x512 x6": the format has a field of its own
  const std::size_t space = text.find(' ');
  return space == std::string::npos ? text : text.substr(space + 1);
}

void print_plan(const graph::CompiledGraph& graph) {
  std::printf("%s: %s\n\npasses, in order\n", graph.name.c_str(), graph.summary.c_str());
  for (std::size_t i = 0; i < graph.order.size(); ++i) {
    const graph::CompiledPass& pass = graph.passes[static_cast<std::size_t>(graph.order[i])];
    std::printf("  %2zu  %-14s %s\n", i, pass.name.c_str(), pass.type.c_str());
  }
  std::printf("\ntextures and buffers                      alive  slot      bytes\n");
  for (const graph::Resource& r : graph.resources) {
    std::printf("  %-38s %2d-%-2d  %4d %10zu  %s %s\n", r.name.c_str(), r.first, r.last, r.slot, r.bytes,
                format_of(r).c_str(), size_of(r).c_str());
  }
  std::printf("  memory %s, %s without aliasing\n", bytes_text(graph.bytes).c_str(),
              bytes_text(graph.bytes_without_aliasing).c_str());
  if (!graph.pruned.empty()) std::printf("\nleft out\n");
  for (const graph::Pruned& p : graph.pruned) std::printf("  %-38s %s\n", p.what.c_str(), p.why.c_str());
  if (!graph.decisions.empty()) std::printf("\ndecisions\n");
  for (const Decision& d : graph.decisions) {
    std::printf("  %-16s %s (%s)\n", d.rule.c_str(), d.decision.c_str(), d.evidence.c_str());
  }
}

void run(const CompileArguments& arguments, const std::vector<std::string>& outputs, const Session& session) {
  const Registry registry = load_registry(session);
  const LoadedScene scene = load_scene(arguments.scene, arguments.camera);
  graph::CompileOptions options = compile_options(arguments, scene.setup);
  options.requested = outputs;
  const graph::CompiledGraph graph = compile(pipeline_of(arguments, scene.setup), registry, scene.facts, options);
  if (session.json) {
    const std::string text = graph::plan_json(graph, scene.facts);
    std::fwrite(text.data(), 1, text.size(), stdout);
  } else {
    print_plan(graph);
  }
}

}  // namespace

void add_plan(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("plan", "Show what runs, what was left out and why, and the memory it takes");
  const auto arguments = std::make_shared<CompileArguments>();
  const auto outputs = std::make_shared<std::vector<std::string>>();
  add_compile_options(*command, *arguments);
  command->add_option("--output", *outputs, "Plan for this output alone; default: all that the pipeline names")
      ->allow_extra_args(false);
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, outputs, &session] { run(*arguments, *outputs, session); });
}

}  // namespace loom::cli
