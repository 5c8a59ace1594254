// loom plan: what runs for this scene, what was left out and why, and the memory it takes.
#include <cstdio>
#include <memory>
#include <string>
#include <variant>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
#include "graph/compile/compile.h"
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

Json facts_json(const SceneFacts& facts) {
  return {{"spot_lights", facts.spot_lights},
          {"wide_spot_lights", facts.wide_spot_lights},
          {"point_lights", facts.point_lights},
          {"directional_lights", facts.directional_lights},
          {"light_faces", facts.light_faces()},
          {"sky", facts.sky},
          {"emissive_triangles", facts.emissive_triangles},
          {"emissive_textures", facts.emissive_textures},
          {"alpha_mask", facts.alpha_mask},
          {"normal_maps", facts.normal_maps},
          {"textures", facts.textures},
          {"moves", facts.moves},
          {"max_chroma", facts.max_chroma},
          {"max_albedo", facts.max_albedo},
          {"thinnest_feature_m", facts.thinnest_feature},
          {"bounds_min", {facts.bounds_min.x, facts.bounds_min.y, facts.bounds_min.z}},
          {"bounds_max", {facts.bounds_max.x, facts.bounds_max.y, facts.bounds_max.z}},
          {"triangles", facts.triangles}};
}

Json plan_json(const graph::CompiledGraph& graph, const SceneFacts& facts) {
  Json document = versioned();
  document["pipeline"] = graph.name;
  Json& passes = document["passes"] = Json::array();
  for (const int index : graph.order) {
    const graph::CompiledPass& pass = graph.passes[static_cast<std::size_t>(index)];
    passes.push_back({{"name", pass.name}, {"type", pass.type}});
  }
  Json& resources = document["resources"] = Json::array();
  for (const graph::Resource& r : graph.resources) {
    resources.push_back({{"name", r.name},
                         {"format", format_of(r)},
                         {"size", size_of(r)},
                         {"bytes", r.bytes},
                         {"first", r.first},
                         {"last", r.last},
                         {"slot", r.slot}});
  }
  document["memory"] = {{"textures_bytes", graph.bytes}, {"without_aliasing_bytes", graph.bytes_without_aliasing}};
  Json& pruned = document["pruned"] = Json::array();
  for (const graph::Pruned& p : graph.pruned) pruned.push_back({{"what", p.what}, {"why", p.why}});
  document["facts"] = facts_json(facts);
  Json& decisions = document["decisions"] = Json::array();
  for (const Decision& d : graph.decisions) {
    decisions.push_back({{"rule", d.rule}, {"decision", d.decision}, {"evidence", d.evidence}});
  }
  return document;
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
    print(plan_json(graph, scene.facts));
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
