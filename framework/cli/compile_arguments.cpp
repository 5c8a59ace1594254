#include "cli/compile_arguments.h"

#include <algorithm>
#include <utility>

#include "reference/analysis.h"

namespace loom::cli {
namespace {

const std::vector<std::string> rules = {"achromatic",  "no-emission", "no-alpha",        "no-normal-map",
                                        "no-specular", "static",      "bands",           "bounces",
                                        "iterations",  "bounds",      "sleeping-probes", "unread"};

graph::Override parse_override(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals || dot == 0 || dot + 1 == equals) {
    throw bad_usage("--set " + text + ": expected pass.param=value", "for example --set lpv.iterations=16");
  }
  return {
      .pass = text.substr(0, dot), .param = text.substr(dot + 1, equals - dot - 1), .value = text.substr(equals + 1)};
}

}  // namespace

LoadedScene load_scene(const std::string& scene, const std::string& camera, const std::string& surfaces,
                       scene::LoadOptions options) {
  Diagnostics diagnostics;
  LoadedScene loaded;
  loaded.setup = scene::load_setup(find_scene(scene), camera, diagnostics, parse_surfaces(surfaces), options);
  if (diagnostics.has_errors()) throw BadInput(diagnostics);
  report(diagnostics);
  loaded.facts = scene::compute_facts(loaded.setup.scene);
  loaded.facts.measured = reference::cached_measurements(loaded.facts.content_hash);
  return loaded;
}

void add_surfaces_option(CLI::App& command, std::string& surfaces) {
  command.add_option("--surfaces", surfaces, "What surfaces reflect: diffuse light alone, or glTF's whole material")
      ->type_name("lambert|ggx");
}

std::optional<scene::SurfaceModel> parse_surfaces(const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (const auto model = scene::surface_model(text)) return model;
  throw bad_usage("--surfaces " + text + ": expected lambert or ggx");
}

void add_load_options(CLI::App& command, scene::LoadOptions& options) {
  command.add_flag("--allow-outside", options.allow_outside,
                   "Let a glTF file name buffers and images outside its own folder");
}

void add_scene_options(CLI::App& command, CompileArguments& arguments) {
  command.add_option("scene", arguments.scene,
                     "A .gltf, .glb or run file (.json), or the name of a shipped one; "
                     "without it the built-in Cornell box");
  command.add_option("-p,--pipeline", arguments.pipeline, "A pipeline file, or the name of a shipped one");
  command.add_option("--size", arguments.size, "Pixels; default: the run file's, else 512x512")->type_name("WxH");
  command.add_option("--set", arguments.set, "Override a parameter: pass.param=value; may be repeated")
      ->type_name("PASS.PARAM=VALUE")
      ->allow_extra_args(false);
  command.add_option("--camera", arguments.camera, "A camera's name in the file, or a JSON object as in a run file");
  add_surfaces_option(command, arguments.surfaces);
  add_load_options(command, arguments.load);
}

void add_compile_options(CLI::App& command, CompileArguments& arguments) {
  add_scene_options(command, arguments);
  command.add_flag("--no-prune{all}", arguments.no_prune,
                   "Leave nothing out and run every pass every frame; --no-prune=RULE switches one rule off");
  command.add_flag("--no-alias", arguments.no_alias, "Give every texture storage of its own");
}

std::vector<graph::Override> parse_overrides(const std::vector<std::string>& set) {
  std::vector<graph::Override> overrides;
  overrides.reserve(set.size());
  for (const std::string& text : set) overrides.push_back(parse_override(text));
  return overrides;
}

graph::CompileOptions compile_options(const CompileArguments& arguments, const scene::Setup& setup) {
  graph::CompileOptions options;
  if (!arguments.size.empty()) {
    options.frame_size = parse_size(arguments.size);
  } else if (setup.size) {
    options.frame_size = *setup.size;
  }
  for (const auto& [target, value] : setup.set) options.overrides.push_back(parse_override(target + "=" + value));
  for (const std::string& text : arguments.set) options.overrides.push_back(parse_override(text));
  options.alias = !arguments.no_alias;
  for (const std::string& rule : arguments.no_prune) {
    if (rule == "all") {
      options.prune = false;
    } else if (std::find(rules.begin(), rules.end(), rule) == rules.end()) {
      const std::string near = nearest_name(rule, rules);
      throw bad_usage("--no-prune=" + rule + ": no such rule",
                      (near.empty() ? "" : "did you mean " + near + "? ") + "rules: " + joined(rules));
    } else {
      options.disabled_rules.push_back(rule);
    }
  }
  return options;
}

std::string pipeline_of(const CompileArguments& arguments, const scene::Setup& setup) {
  if (!arguments.pipeline.empty()) return find_pipeline(arguments.pipeline);
  if (!setup.pipeline.empty()) return find_pipeline(setup.pipeline);
  throw bad_usage("no pipeline: give -p PIPELINE, or name one in the run file",
                  "shipped: " + joined(shipped_pipelines()));
}

graph::CompiledGraph compile(const std::string& pipeline, const Registry& registry, const SceneFacts& facts,
                             const graph::CompileOptions& options) {
  graph::CompileResult result = graph::compile_file(pipeline, registry, facts, options);
  if (!result.graph || result.diagnostics.has_errors()) throw BadInput(result.diagnostics);
  report(result.diagnostics);
  return std::move(*result.graph);
}

}  // namespace loom::cli
