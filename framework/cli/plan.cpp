// loom plan: what runs for this scene, what was left out and why, and the memory it takes.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
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

/// What a frame of a still view writes: outputs and working storage of the passes that do not keep theirs.
std::size_t written_bytes(const graph::CompiledGraph& graph) {
  std::set<int> written;
  for (const int index : graph.order) {
    const graph::CompiledPass& pass = graph.passes[static_cast<std::size_t>(index)];
    if (pass.ports.keeps_outputs) continue;
    for (const graph::BoundPort& port : pass.bound) {
      if (port.is_input) continue;
      for (const graph::BoundMember& member : port.members)
        if (member.resource != graph::none) written.insert(member.resource);
    }
  }
  std::size_t bytes = 0;
  for (const int resource : written) bytes += graph.resources[static_cast<std::size_t>(resource)].bytes;
  return bytes;
}

/// What a plan takes where one rule is off, or all are.
struct Without {
  std::string rule;  ///< empty: all
  std::size_t memory = 0, written = 0, passes = 0;
};

/// For each rule that decided something, and for all together.
std::vector<Without> compare_rules(const graph::CompiledGraph& graph, const std::string& pipeline,
                                   const Registry& registry, const SceneFacts& facts, graph::CompileOptions options) {
  std::vector<std::string> rules;
  for (const Decision& decision : graph.decisions)
    if (std::find(rules.begin(), rules.end(), decision.rule) == rules.end()) rules.push_back(decision.rule);
  std::vector<Without> results;
  const auto add = [&](const std::string& rule) {
    const graph::CompileResult result = graph::compile_file(pipeline, registry, facts, options);
    if (!result.graph) return;
    results.push_back({rule, result.graph->bytes, written_bytes(*result.graph), result.graph->order.size()});
  };
  for (const std::string& rule : rules) {
    options.disabled_rules.push_back(rule);
    add(rule);
    options.disabled_rules.pop_back();
  }
  options.prune = false;
  add("");
  return results;
}

std::string change_text(std::size_t without, std::size_t with) {
  if (without == with) return "0";
  return without > with ? bytes_text(without - with) : "-" + bytes_text(with - without);
}

void print_savings(const graph::CompiledGraph& graph, const std::vector<Without>& rules) {
  const std::size_t written = written_bytes(graph);
  std::printf("\nsaved by each rule    memory   written each frame   passes\n");
  for (const Without& w : rules) {
    std::printf("  %-16s %11s %20s %8td\n", w.rule.empty() ? "all together" : w.rule.c_str(),
                change_text(w.memory, graph.bytes).c_str(), change_text(w.written, written).c_str(),
                static_cast<std::ptrdiff_t>(w.passes) - static_cast<std::ptrdiff_t>(graph.order.size()));
  }
  const Without& none = rules.back();
  std::printf("  --no-prune takes %s and writes %s; this plan %s and %s\n", bytes_text(none.memory).c_str(),
              bytes_text(none.written).c_str(), bytes_text(graph.bytes).c_str(), bytes_text(written).c_str());
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
    std::printf("  %-16s %-10s %s (%s)\n", d.rule.c_str(), d.pass.c_str(), d.decision.c_str(), d.evidence.c_str());
  }
}

void run(const CompileArguments& arguments, const std::vector<std::string>& outputs, const Session& session) {
  const Registry registry = load_registry(session);
  const LoadedScene scene = load_scene(arguments.scene, arguments.camera, arguments.surfaces, arguments.load);
  graph::CompileOptions options = compile_options(arguments, scene.setup);
  options.requested = outputs;
  const std::string pipeline = pipeline_of(arguments, scene.setup);
  const graph::CompiledGraph graph = compile(pipeline, registry, scene.facts, options);
  const std::vector<Without> rules = compare_rules(graph, pipeline, registry, scene.facts, options);
  if (session.json) {
    Json document = Json::parse(graph::plan_json(graph, scene.facts));
    document["memory"]["written_bytes"] = written_bytes(graph);
    Json& savings = document["without_rule"] = Json::array();
    for (const Without& w : rules)
      savings.push_back({{"rule", w.rule.empty() ? "all" : w.rule},
                         {"textures_bytes", w.memory},
                         {"written_bytes", w.written},
                         {"passes", w.passes}});
    print(document);
  } else {
    print_plan(graph);
    if (!rules.empty()) print_savings(graph, rules);
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
