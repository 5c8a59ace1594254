#pragma once
// A scene and a pipeline as the command line names them, up to the compiled graph.
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/session.h"
#include "graph/compile/compile.h"
#include "loom/facts.h"
#include "loom/registry.h"
#include "scene/load.h"

namespace loom::cli {

/// A scene with its facts; warnings go to stderr.
struct LoadedScene {
  scene::Setup setup;
  SceneFacts facts;
};
/// `surfaces`: lambert, ggx, or empty: what the run file says. Throws BadInput.
LoadedScene load_scene(const std::string& scene, const std::string& camera, const std::string& surfaces,
                       scene::LoadOptions options);
/// `--surfaces`, for every command that takes a scene.
void add_surfaces_option(CLI::App& command, std::string& surfaces);
/// Nothing where the text is empty. Throws BadInput.
std::optional<scene::SurfaceModel> parse_surfaces(const std::string& text);
/// `--allow-outside`.
void add_load_options(CLI::App& command, scene::LoadOptions& options);

/// The options of every subcommand that compiles one pipeline, and what they come to.
struct CompileArguments {
  std::string scene, pipeline, camera, surfaces, size;
  std::vector<std::string> set;
  std::vector<std::string> no_prune;
  bool no_alias = false;
  scene::LoadOptions load;
};
void add_compile_options(CLI::App& command, CompileArguments& arguments);
/// Those of them that say what is seen: scene, pipeline, size, parameters, camera.
void add_scene_options(CLI::App& command, CompileArguments& arguments);
/// The values of --set. Throws BadInput.
std::vector<graph::Override> parse_overrides(const std::vector<std::string>& set);
/// `--set` after what the run file sets; --size, the run file's size, or 512x512.
graph::CompileOptions compile_options(const CompileArguments& arguments, const scene::Setup& setup);
/// -p, or the run file's pipeline. Throws BadInput that lists the shipped ones where there is neither.
std::string pipeline_of(const CompileArguments& arguments, const scene::Setup& setup);
/// Compiles; warnings go to stderr, errors are thrown as BadInput.
graph::CompiledGraph compile(const std::string& pipeline, const Registry& registry, const SceneFacts& facts,
                             const graph::CompileOptions& options);

}  // namespace loom::cli
