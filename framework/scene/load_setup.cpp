// What a scene path means, with every default filled in: the built-in scene, run files, the camera, the headlamp.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/data_dir.h"
#include "scene/bounds.h"
#include "scene/content_hash.h"
#include "scene/gltf/load_gltf.h"
#include "scene/load.h"
#include "scene/run_file.h"
#include "scene/sky.h"

namespace loom::scene {
namespace {

namespace fs = std::filesystem;
constexpr double pi = 3.14159265358979323846;

std::string extension_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string builtin_scene() { return (fs::path(data_dir()) / "configs" / "scenes" / "cornell-box.gltf").string(); }

/// Everything in view, from +Z, a little from the right and from above.
Camera framing_camera(const Box& box, double aspect) {
  Camera camera;
  camera.name = "framing";
  const glm::dvec3 backward = glm::normalize(glm::dvec3(.4, .3, 1));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), backward));
  const glm::dvec3 up = glm::cross(backward, right);
  constexpr double margin = .95;
  const double tan_y = margin * std::tan(.5 * camera.yfov_rad);
  const double tan_x = tan_y * aspect;
  const glm::dvec3 half = .5 * box.extent();
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        half * glm::dvec3((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    const double ahead = glm::dot(p, backward);
    distance =
        std::max({distance, ahead + std::abs(glm::dot(p, up)) / tan_y, ahead + std::abs(glm::dot(p, right)) / tan_x});
  }
  if (distance == 0) distance = 1;
  camera.target = box.centre();
  camera.eye = camera.target + distance * backward;
  return camera;
}

void choose_named(Setup& setup, const std::string& name, const SourceLocation& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < setup.scene.cameras.size(); ++i) {
    if (setup.scene.cameras[i].name == name) {
      setup.camera_index = static_cast<int>(i);
      setup.camera = setup.scene.cameras[i];
      return;
    }
    names.push_back(setup.scene.cameras[i].name);
  }
  std::string hint = names.empty() ? "the scene has no camera" : "it has";
  for (std::size_t i = 0; i < names.size(); ++i) hint += (i == 0 ? " \"" : ", \"") + names[i] + "\"";
  if (const std::string nearest = nearest_name(name, names); !nearest.empty())
    hint = "did you mean \"" + nearest + "\"?";
  throw BadInput(
      Diagnostic{Severity::error, "unknown-camera", "the scene has no camera \"" + name + "\"", where, hint});
}

void choose_camera(Setup& setup, const std::optional<CameraChoice>& choice, const Box& box) {
  if (choice) {
    if (const Camera* own = std::get_if<Camera>(&choice->camera)) {
      setup.camera = *own;
    } else {
      choose_named(setup, std::get<std::string>(choice->camera), choice->where);
    }
  } else if (!setup.scene.cameras.empty()) {
    setup.camera_index = 0;
    setup.camera = setup.scene.cameras.front();
  } else {
    const double aspect = setup.size ? static_cast<double>(setup.size->x) / setup.size->y : 1;
    setup.camera = framing_camera(box, aspect);
  }
}

bool anything_emits(const Scene& scene) {
  if (!scene.lights.empty() || scene.sky != glm::vec3(0)) return true;
  for (const Instance& instance : scene.instances) {
    for (const Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      if (scene.materials[static_cast<std::size_t>(primitive.material)].emissive != glm::vec3(0)) return true;
    }
  }
  return false;
}

void add_headlamp(Setup& setup, const Box& box, Diagnostics& diagnostics) {
  Light lamp;
  lamp.name = "headlamp";
  lamp.position = setup.camera.eye;
  const double diagonal = glm::length(box.extent());
  double distance = std::max(glm::length(box.centre() - setup.camera.eye), .25 * diagonal);
  if (distance == 0) distance = 1;
  const double intensity = pi * distance * distance;
  lamp.intensity = glm::vec3(static_cast<float>(intensity));
  setup.scene.lights.push_back(lamp);
  diagnostics.warning("headlamp",
                      "the scene has no light, no emitter and no sky: a point light of " + std::to_string(intensity) +
                          " W/sr was put at the camera",
                      {setup.scene.path, 0, 0, ""}, "give lights or a sky in a run file");
}

void replace_lights(Scene& scene, std::vector<Light> lights) {
  scene.lights = std::move(lights);
  for (Node& node : scene.nodes) node.light = -1;
}

}  // namespace

std::optional<SurfaceModel> surface_model(std::string_view name) {
  if (name == "lambert") return SurfaceModel::lambert;
  if (name == "ggx") return SurfaceModel::ggx;
  return std::nullopt;
}

Setup load_setup(const std::string& path, const std::string& camera, Diagnostics& diagnostics,
                 std::optional<SurfaceModel> surfaces, LoadOptions options) {
  RunFile run;
  run.scene = path;
  if (extension_of(path) == ".json") run = read_run_file(path);
  // The command line has the last word.
  if (!camera.empty()) run.camera = parse_camera(camera);
  if (run.scene.empty()) run.scene = builtin_scene();

  Setup setup;
  Diagnostics found;
  setup.scene = gltf::load(run.scene, found, options.allow_outside);
  setup.scene.surfaces = surfaces.value_or(run.surfaces);
  for (const Diagnostic& diagnostic : found.all()) {
    // Only where all surfaces are diffuse is a metal black.
    if (diagnostic.code != "gltf-metal" || setup.scene.surfaces == SurfaceModel::lambert) diagnostics.add(diagnostic);
  }
  setup.size = run.size;
  setup.pipeline = run.pipeline;
  setup.set = std::move(run.set);
  if (run.lights) replace_lights(setup.scene, std::move(*run.lights));
  if (run.sky) apply_sky(setup.scene, *run.sky, diagnostics);
  recentre(setup.scene);
  if (run.camera) {
    if (Camera* own = std::get_if<Camera>(&run.camera->camera)) {
      own->eye -= setup.scene.origin;
      own->target -= setup.scene.origin;
    }
  }
  const Box box = scene_box(setup.scene);
  choose_camera(setup, run.camera, box);
  if (!anything_emits(setup.scene)) add_headlamp(setup, box, diagnostics);
  setup.scene.content_hash = content_hash(setup.scene);
  return setup;
}

}  // namespace loom::scene
