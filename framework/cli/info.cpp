// loom info: what is in a scene, as the framework reads it.
#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
#include "scene/load.h"

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

template <class V>
Json vector_json(const V& v) {
  return {v.x, v.y, v.z};
}

Json info_json(const LoadedScene& loaded) {
  const scene::Scene& scene = loaded.setup.scene;
  const SceneFacts& facts = loaded.facts;
  Json document = versioned();
  document["scene"] = scene.path;
  document["triangles"] = facts.triangles;
  document["meshes"] = scene.meshes.size();
  document["instances"] = scene.instances.size();
  document["materials"] = scene.materials.size();
  document["images"] = scene.images.size();
  document["animations"] = scene.animations.size();
  document["skins"] = scene.skins.size();
  document["bounds_min"] = vector_json(facts.bounds_min);
  document["bounds_max"] = vector_json(facts.bounds_max);
  document["max_albedo"] = facts.max_albedo;
  document["max_chroma"] = facts.max_chroma;
  document["thinnest_feature_m"] = facts.thinnest_feature;
  document["emissive_triangles"] = facts.emissive_triangles;
  document["alpha_mask"] = facts.alpha_mask;
  document["normal_maps"] = facts.normal_maps;
  document["moves"] = facts.moves;
  document["moving_triangles"] = facts.moving_triangles;
  document["sky"] = vector_json(scene.sky);
  Json& lights = document["lights"] = Json::array();
  for (const scene::Light& light : scene.lights) {
    lights.push_back({{"name", light.name},
                      {"type", name_of(light.kind)},
                      {"position", vector_json(light.position)},
                      {"direction", vector_json(light.direction)},
                      {"intensity", vector_json(light.intensity)}});
  }
  Json& cameras = document["cameras"] = Json::array();
  for (const scene::Camera& camera : scene.cameras) {
    cameras.push_back({{"name", camera.name},
                       {"eye", vector_json(camera.eye)},
                       {"target", vector_json(camera.target)},
                       {"up", vector_json(camera.up)}});
  }
  const scene::Camera& used = loaded.setup.camera;
  document["camera"] = {{"name", used.name},
                        {"eye", vector_json(used.eye)},
                        {"target", vector_json(used.target)},
                        {"up", vector_json(used.up)}};
  return document;
}

void print_info(const LoadedScene& loaded) {
  const scene::Scene& scene = loaded.setup.scene;
  const SceneFacts& f = loaded.facts;
  const auto yes = [](bool value) { return value ? "yes" : "no"; };
  std::printf("%s\n", scene.path.c_str());
  std::printf("  triangles   %zu in %zu meshes, %zu instances\n", f.triangles, scene.meshes.size(),
              scene.instances.size());
  std::printf("  materials   %zu, %zu images; alpha mask %s, normal maps %s\n", scene.materials.size(),
              scene.images.size(), yes(f.alpha_mask), yes(f.normal_maps));
  std::printf("  bounds      (%g, %g, %g) to (%g, %g, %g) m, thinnest feature %g m\n", f.bounds_min.x, f.bounds_min.y,
              f.bounds_min.z, f.bounds_max.x, f.bounds_max.y, f.bounds_max.z, f.thinnest_feature);
  std::printf("  albedo      at most %.3g, chroma at most %.3g\n", f.max_albedo, f.max_chroma);
  std::printf("  emission    %d triangles; sky (%g, %g, %g) W/(m2 sr)\n", f.emissive_triangles, scene.sky.r,
              scene.sky.g, scene.sky.b);
  std::printf("  moves       %s (%zu animations, %zu skins), %zu triangles\n", yes(f.moves), scene.animations.size(),
              scene.skins.size(), f.moving_triangles);
  for (const scene::Light& light : scene.lights) {
    std::printf("  light       %s %s at (%g, %g, %g), (%g, %g, %g) %s\n", name_of(light.kind), light.name.c_str(),
                light.position.x, light.position.y, light.position.z, light.intensity.r, light.intensity.g,
                light.intensity.b, light.kind == scene::LightKind::directional ? "W/m2" : "W/sr");
  }
  for (const scene::Camera& camera : scene.cameras) std::printf("  camera      %s\n", camera.name.c_str());
  const scene::Camera& used = loaded.setup.camera;
  std::printf("  seen from   (%g, %g, %g) towards (%g, %g, %g)\n", used.eye.x, used.eye.y, used.eye.z, used.target.x,
              used.target.y, used.target.z);
}

}  // namespace

void add_info(CLI::App& app, Session& session) {
  struct Arguments {
    std::string scene, camera;
  };
  auto* command = app.add_subcommand("info", "Show what is in a scene, as Lightloom reads it");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "A .gltf, .glb or run file; without it the built-in Cornell box");
  command->add_option("--camera", arguments->camera, "A camera's name in the file, or a JSON object");
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] {
    const LoadedScene loaded = load_scene(arguments->scene, arguments->camera);
    if (session.json) {
      print(info_json(loaded));
    } else {
      print_info(loaded);
    }
  });
}

}  // namespace loom::cli
