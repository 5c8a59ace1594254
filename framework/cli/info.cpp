// loom info: what is in a scene, as the framework reads it.
#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/facts_out.h"
#include "cli/json_out.h"
#include "scene/load.h"
#include "scene/sky.h"

namespace loom::cli {
namespace {

const char* name_of(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::point:
      return "point";
    case scene::LightKind::spot:
      return "spot";
    case scene::LightKind::directional:
      break;
  }
  return "directional";
}

Json info_json(const LoadedScene& loaded) {
  const scene::Scene& scene = loaded.setup.scene;
  const SceneFacts& facts = loaded.facts;
  Json document = versioned();
  document["scene"] = scene.path;
  document["meshes"] = scene.meshes.size();
  document["instances"] = scene.instances.size();
  document["materials"] = scene.materials.size();
  document["images"] = scene.images.size();
  document["animations"] = scene.animations.size();
  document["skins"] = scene.skins.size();
  add_facts(document, facts, scene.origin);
  document["sky"] = vector_json(scene.sky);
  document["sky_bands"] = facts.sky_bands;
  if (scene.sky_image) {
    Json& image = document["sky_image"] = Json::parse(scene.sky_image->source);
    image["width"] = scene.sky_image->width;
    image["height"] = scene.sky_image->height;
  }
  Json& lights = document["lights"] = Json::array();
  for (const scene::Light& light : scene.lights) {
    lights.push_back({{"name", light.name},
                      {"type", name_of(light.kind)},
                      {"position", vector_json(light.position + scene.origin)},
                      {"direction", vector_json(light.direction)},
                      {"intensity", vector_json(light.intensity)}});
  }
  Json& cameras = document["cameras"] = Json::array();
  for (const scene::Camera& camera : scene.cameras) {
    cameras.push_back({{"name", camera.name},
                       {"eye", vector_json(camera.eye + scene.origin)},
                       {"target", vector_json(camera.target + scene.origin)},
                       {"up", vector_json(camera.up)}});
  }
  const scene::Camera& used = loaded.setup.camera;
  document["camera"] = {{"name", used.name},
                        {"eye", vector_json(used.eye + scene.origin)},
                        {"target", vector_json(used.target + scene.origin)},
                        {"up", vector_json(used.up)}};
  return document;
}

void print_info(const LoadedScene& loaded) {
  const scene::Scene& scene = loaded.setup.scene;
  const SceneFacts& f = loaded.facts;
  std::printf("%s\n", scene.path.c_str());
  std::printf("  triangles   %zu in %zu meshes, %zu instances\n", f.triangles, scene.meshes.size(),
              scene.instances.size());
  std::printf("  materials   %zu, %zu images; %zu animations, %zu skins\n", scene.materials.size(), scene.images.size(),
              scene.animations.size(), scene.skins.size());
  print_facts(f, scene.origin);
  std::printf("  sky         %s(%g, %g, %g) W/(m2 sr)\n", scene.sky_image ? "mean " : "", scene.sky.r, scene.sky.g,
              scene.sky.b);
  if (scene.sky_image) {
    std::printf("              %dx%d, %s\n", scene.sky_image->width, scene.sky_image->height,
                scene.sky_image->source.c_str());
    std::printf("              mean square by band: 0 %.4f, 1 %.4f, 2 %.4f, above %.4f\n", f.sky_bands[0],
                f.sky_bands[1], f.sky_bands[2], f.sky_bands[3]);
  }
  for (const scene::Light& light : scene.lights) {
    const glm::dvec3 position = light.position + scene.origin;
    std::printf("  light       %s %s at (%g, %g, %g), (%g, %g, %g) %s\n", name_of(light.kind), light.name.c_str(),
                position.x, position.y, position.z, light.intensity.r, light.intensity.g, light.intensity.b,
                light.kind == scene::LightKind::directional ? "W/m2" : "W/sr");
  }
  for (const scene::Camera& camera : scene.cameras) std::printf("  camera      %s\n", camera.name.c_str());
  const scene::Camera& used = loaded.setup.camera;
  const glm::dvec3 eye = used.eye + scene.origin;
  const glm::dvec3 target = used.target + scene.origin;
  std::printf("  seen from   (%g, %g, %g) towards (%g, %g, %g)\n", eye.x, eye.y, eye.z, target.x, target.y, target.z);
}

}  // namespace

void add_info(CLI::App& app, Session& session) {
  struct Arguments {
    std::string scene, camera, surfaces;
    scene::LoadOptions load;
  };
  auto* command = app.add_subcommand("info", "Show what is in a scene, as Lightloom reads it");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "A .gltf, .glb or run file; without it the built-in Cornell box");
  command->add_option("--camera", arguments->camera, "A camera's name in the file, or a JSON object");
  add_surfaces_option(*command, arguments->surfaces);
  add_json_option(*command, session);
  add_load_options(*command, arguments->load);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] {
    const LoadedScene loaded = load_scene(arguments->scene, arguments->camera, arguments->surfaces, arguments->load);
    if (session.json) {
      print(info_json(loaded));
    } else {
      print_info(loaded);
    }
  });
}

}  // namespace loom::cli
