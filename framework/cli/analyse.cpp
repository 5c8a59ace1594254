// loom analyse: the facts of a scene, those included that only rays can tell.
#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/facts_out.h"
#include "cli/json_out.h"
#include "loom/rules.h"
#include "reference/analysis.h"
#include "scene/load.h"

namespace loom::cli {
namespace {

struct Arguments {
  std::string scene, camera, surfaces;
  scene::LoadOptions load;
  bool again = false;
};

/// The lowest order that keeps what it leaves out of irradiance below the threshold of the rule `bands`.
int required_order(const SceneMeasurements& measured) {
  int order = 0;
  while (order + 1 < static_cast<int>(SceneMeasurements::bands) &&
         rules::above_band(measured, order) >= rules::bands_threshold)
    ++order;
  return order;
}

void run(const Arguments& arguments, const Session& session) {
  LoadedScene loaded = load_scene(arguments.scene, arguments.camera, arguments.surfaces, arguments.load);
  if (!loaded.facts.measured || arguments.again) {
    loaded.facts.measured = reference::measure_scene(loaded.setup.scene, loaded.setup.camera);
    reference::cache_measurements(loaded.facts.content_hash, *loaded.facts.measured);
  }
  const int order = required_order(*loaded.facts.measured);
  if (session.json) {
    Json document = versioned();
    document["scene"] = loaded.setup.scene.path;
    add_facts(document, loaded.facts, loaded.setup.scene.origin);
    document["required_order"] = order;
    print(document);
    return;
  }
  std::printf("%s\n  triangles   %zu\n", loaded.setup.scene.path.c_str(), loaded.facts.triangles);
  print_facts(loaded.facts, loaded.setup.scene.origin);
  std::printf("  irradiance takes order %d: above it lies less than %g of its mean square\n", order,
              rules::bands_threshold);
}

}  // namespace

void add_analyse(CLI::App& app, Session& session) {
  auto* command =
      app.add_subcommand("analyse", "Measure a scene: what is lit, how thin walls are, which bands light has");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "A .gltf, .glb or run file; without it the built-in Cornell box");
  command->add_option("--camera", arguments->camera, "A camera's name in the file, or a JSON object");
  add_surfaces_option(*command, arguments->surfaces);
  command->add_flag("--again", arguments->again, "Measure also where the cache knows the scene");
  add_json_option(*command, session);
  add_load_options(*command, arguments->load);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
