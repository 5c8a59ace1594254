// loom check: are these pipelines right? All diagnostics of all of them.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
#include "graph/compile/compile.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::vector<std::string> pipelines;
  std::string scene, surfaces;
  scene::LoadOptions load;
};

void run(const Arguments& arguments, Session& session) {
  Diagnostics all;
  const Registry registry = load_registry(session, &all);
  const LoadedScene scene = load_scene(arguments.scene, "", arguments.surfaces, arguments.load);
  const Diagnostics refused = all;
  all = {};
  bool bad = false;
  for (const std::string& name : arguments.pipelines) {
    Diagnostics found;
    std::size_t passes = 0;
    try {
      const graph::CompileResult result = graph::compile_file(find_pipeline(name), registry, scene.facts);
      found = result.diagnostics;
      if (result.graph) passes = result.graph->order.size();
    } catch (const BadInput& error) {
      found.append(error.diagnostics());
    }
    report(found);
    all.append(found);
    if (found.has_errors()) {
      bad = true;
    } else if (!session.json) {
      std::printf("%s: ok, %zu passes run\n", name.c_str(), passes);
    }
  }
  if (session.json) {
    Json document = versioned();
    Diagnostics shown = refused;
    shown.append(all);
    document["ok"] = !bad;
    document["diagnostics"] = to_json(shown);
    print(document);
  }
  if (bad) session.exit_code = 2;
}

}  // namespace

void add_check(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("check", "Check pipelines; print every diagnostic");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("pipelines", arguments->pipelines, "Pipeline files, or names of shipped ones")->required();
  command->add_option("--scene", arguments->scene, "Check for this scene; default: the built-in one");
  add_surfaces_option(*command, arguments->surfaces);
  add_json_option(*command, session);
  add_load_options(*command, arguments->load);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
