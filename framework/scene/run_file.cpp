#include "scene/run_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <sstream>
#include <system_error>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "scene/load.h"
#include "scene/run_reader.h"

namespace loom::scene {
namespace {

namespace fs = std::filesystem;
using json::Kind;
using json::Node;
using run::Reader;
using run::with_place;

constexpr int max_size = 16384;  // pixels a side, what OpenGL 4.5 guarantees

/// A path with ${LOOM_SCENES} replaced, relative to the folder of the run file.
std::string read_path(Reader& reader, const Node* node, std::string_view what, const fs::path& folder) {
  std::string text = reader.text(node, what);
  if (text.empty()) return {};
  constexpr std::string_view variable = "${LOOM_SCENES}";
  if (const std::size_t at = text.find(variable); at != std::string::npos) {
    const char* scenes = std::getenv("LOOM_SCENES");
    if (scenes == nullptr || *scenes == '\0') {
      reader.error(*node, "scenes-unset", std::string(what) + " uses ${LOOM_SCENES}, which is not set",
                   "set LOOM_SCENES to the folder of scenes that are not shipped");
      return {};
    }
    text.replace(at, variable.size(), scenes);
  }
  if (text.find("${") != std::string::npos) {
    reader.error(*node, "unknown-variable", std::string(what) + " uses a variable that is not ${LOOM_SCENES}");
    return {};
  }
  return fs::path(text).is_absolute() ? text : (folder / text).lexically_normal().string();
}

std::optional<Camera> read_camera(Reader& reader, const Node& node) {
  if (!reader.object(node, "a camera", {"eye", "target", "up", "yfov_deg"})) return std::nullopt;
  Camera camera;
  for (const char* key : {"eye", "target"}) {
    if (node.find(key) == nullptr) reader.error(node, "missing-key", std::string("a camera needs \"") + key + "\"");
  }
  const std::optional<glm::dvec3> eye = reader.vector(node.find("eye"), "eye");
  const std::optional<glm::dvec3> target = reader.vector(node.find("target"), "target");
  camera.up = reader.vector(node.find("up"), "up").value_or(camera.up);
  if (const std::optional<double> degrees = reader.number(node.find("yfov_deg"), "yfov_deg", .01, 179)) {
    camera.yfov_rad = glm::radians(*degrees);
  }
  if (!eye || !target) return std::nullopt;
  camera.eye = *eye;
  camera.target = *target;
  const glm::dvec3 forward = camera.target - camera.eye;
  if (glm::length(forward) == 0) {
    reader.error(node, "run-range", "the camera's eye and target are the same point");
  } else if (glm::length(glm::cross(forward, camera.up)) <= 1e-9 * glm::length(forward) * glm::length(camera.up)) {
    reader.error(node, "run-range", "the camera's up points along its view");
  }
  return camera;
}

std::vector<std::string> light_keys(LightKind kind) {
  std::vector<std::string> keys{"type", "name", "color", "intensity"};
  if (kind != LightKind::directional) keys.insert(keys.end(), {"position", "range"});
  if (kind != LightKind::point) keys.emplace_back("direction");
  if (kind == LightKind::spot) keys.insert(keys.end(), {"inner_deg", "outer_deg"});
  return keys;
}

std::optional<LightKind> read_kind(Reader& reader, const Node& node) {
  const Node* type = node.find("type");
  if (type == nullptr) {
    reader.error(node, "missing-key", "a light needs a \"type\"", "it may be point, spot or directional");
    return std::nullopt;
  }
  const std::string name = reader.text(type, "type");
  if (name == "point") return LightKind::point;
  if (name == "spot") return LightKind::spot;
  if (name == "directional") return LightKind::directional;
  if (type->is(Kind::string)) {
    const std::string nearest = nearest_name(name, {"point", "spot", "directional"});
    reader.error(*type, "unknown-light", "there is no light of type \"" + name + "\"",
                 nearest.empty() ? "it may be point, spot or directional" : "did you mean \"" + nearest + "\"?");
  }
  return std::nullopt;
}

void read_cone(Reader& reader, const Node& node, Light& light) {
  constexpr double widest = 90;
  const std::optional<double> inner = reader.number(node.find("inner_deg"), "inner_deg", 0, widest);
  const std::optional<double> outer = reader.number(node.find("outer_deg"), "outer_deg", 0, widest);
  if (inner) light.inner_rad = glm::radians(*inner);
  if (outer) light.outer_rad = glm::radians(*outer);
  if (light.inner_rad > light.outer_rad || light.outer_rad == 0) {
    reader.error(node, "run-range", "a spot's inner_deg must not exceed its outer_deg, which must be over 0");
  }
}

std::optional<Light> read_light(Reader& reader, const Node& node) {
  if (!node.is(Kind::object)) {
    reader.error(node, "run-type", with_place("a light must be an object", node));
    return std::nullopt;
  }
  const std::optional<LightKind> kind = read_kind(reader, node);
  if (!kind) return std::nullopt;
  Light light;
  light.kind = *kind;
  constexpr std::string_view names[] = {"a point light", "a spot light", "a directional light"};
  reader.object(node, names[static_cast<std::size_t>(*kind)], light_keys(*kind));
  light.name = reader.text(node.find("name"), "name");
  const char* needed = *kind == LightKind::directional ? "direction" : "position";
  if (node.find(needed) == nullptr)
    reader.error(node, "missing-key", "this light needs a \"" + std::string(needed) + "\"");
  if (*kind != LightKind::directional)
    light.position = reader.vector(node.find("position"), "position").value_or(light.position);
  if (*kind != LightKind::point) {
    const glm::dvec3 direction = reader.vector(node.find("direction"), "direction").value_or(light.direction);
    const double length = glm::length(direction);
    if (length > 0) {
      light.direction = direction / length;
    } else {
      reader.error(*node.find("direction"), "run-range", "the direction has no length");
    }
  }
  if (*kind == LightKind::spot) read_cone(reader, node, light);
  const glm::dvec3 color = reader.vector(node.find("color"), "color", 0).value_or(glm::dvec3(1));
  const double intensity =
      reader.number(node.find("intensity"), "intensity", 0, std::numeric_limits<float>::max()).value_or(1);
  light.intensity = glm::vec3(color * intensity);
  return light;
}

std::optional<std::vector<Light>> read_lights(Reader& reader, const Node* node) {
  if (node == nullptr) return std::nullopt;
  if (!node->is(Kind::array)) {
    reader.error(*node, "run-type", with_place("lights must be an array", *node));
    return std::nullopt;
  }
  std::vector<Light> lights;
  for (const Node& item : node->items) {
    if (std::optional<Light> light = read_light(reader, item)) lights.push_back(std::move(*light));
  }
  return lights;
}

/// The sun by its direction, or by its height and its azimuth from −Z towards +X.
glm::dvec3 read_sun(Reader& reader, const Node& node) {
  const Node* direction = node.find("sun_direction");
  if (direction != nullptr) {
    for (const char* other : {"sun_elevation_deg", "sun_azimuth_deg"}) {
      if (const Node* both = node.find(other))
        reader.error(*both, "run-range", std::string("sun_direction and ") + other + " exclude each other");
    }
    const glm::dvec3 sun = reader.vector(direction, "sun_direction").value_or(glm::dvec3(0, 1, 0));
    if (glm::length(sun) > 0 && sun.y >= 0) return glm::normalize(sun);
    reader.error(*direction, "run-range", "sun_direction, towards the sun, must have a length and not point down");
    return {0, 1, 0};
  }
  if (node.find("sun_elevation_deg") == nullptr)
    reader.error(node, "missing-key", "a clear sky needs a \"sun_elevation_deg\" or a \"sun_direction\"");
  const double height =
      glm::radians(reader.number(node.find("sun_elevation_deg"), "sun_elevation_deg", 0, 90).value_or(90));
  const double azimuth =
      glm::radians(reader.number(node.find("sun_azimuth_deg"), "sun_azimuth_deg", -360, 360).value_or(0));
  return {std::sin(azimuth) * std::cos(height), std::sin(height), -std::cos(azimuth) * std::cos(height)};
}

std::optional<SkyChoice> read_sky_choice(Reader& reader, const Node& node, const fs::path& folder) {
  const Node *image = node.find("image"), *model = node.find("model");
  std::vector<std::string> keys{"radiance", "image", "model"};
  if (image != nullptr) keys = {"image", "scale", "rotation_deg"};
  if (model != nullptr)
    keys = {"model", "scale", "rotation_deg", "sun_elevation_deg", "sun_azimuth_deg", "sun_direction", "turbidity"};
  if (image == nullptr && model == nullptr && node.find("radiance") != nullptr) keys = {"radiance"};
  if (!reader.object(node, "sky", keys)) return std::nullopt;
  SkyChoice sky;
  sky.where = node.where;
  if (image == nullptr && model == nullptr) {
    const std::optional<glm::dvec3> radiance = reader.vector(node.find("radiance"), "radiance", 0);
    if (!radiance) return std::nullopt;
    sky.radiance = glm::vec3(*radiance);
    return sky;
  }
  sky.scale = reader.number(node.find("scale"), "scale", 0, std::numeric_limits<float>::max()).value_or(1);
  sky.rotation_deg = reader.number(node.find("rotation_deg"), "rotation_deg", -360, 360).value_or(0);
  if (model == nullptr) {
    sky.where = image->where;
    sky.image = read_path(reader, image, "image", folder);
    return sky;
  }
  if (const std::string name = reader.text(model, "model"); name != "clear" && model->is(Kind::string))
    reader.error(*model, "unknown-sky", "there is no sky of model \"" + name + "\"", "it may be clear");
  sky.clear = true;
  sky.sun = read_sun(reader, node);
  sky.turbidity = reader.number(node.find("turbidity"), "turbidity", 2, 10).value_or(sky.turbidity);
  return sky;
}

std::optional<glm::ivec2> read_size(Reader& reader, const Node* node) {
  if (node == nullptr) return std::nullopt;
  if (!node->is(Kind::array) || node->items.size() != 2 || !node->items[0].is(Kind::integer) ||
      !node->items[1].is(Kind::integer)) {
    reader.error(*node, "run-type", "size must be an array of two integers");
    return std::nullopt;
  }
  const auto side = [&](std::size_t i) { return reader.number(&node->items[i], "size", 1, max_size); };
  const std::optional<double> width = side(0);
  const std::optional<double> height = side(1);
  if (!width || !height) return std::nullopt;
  return glm::ivec2(static_cast<int>(*width), static_cast<int>(*height));
}

SurfaceModel read_surfaces(Reader& reader, const Node* node) {
  const std::string name = reader.text(node, "surfaces");
  if (node == nullptr || !node->is(Kind::string)) return SurfaceModel::lambert;
  const std::optional<SurfaceModel> model = surface_model(name);
  if (!model) {
    const std::string nearest = nearest_name(name, {"lambert", "ggx"});
    reader.error(*node, "run-range", "there are no surfaces \"" + name + "\"",
                 nearest.empty() ? "they may be lambert or ggx" : "did you mean \"" + nearest + "\"?");
  }
  return model.value_or(SurfaceModel::lambert);
}

std::optional<CameraChoice> read_camera_choice(Reader& reader, const Node* node) {
  if (node == nullptr) return std::nullopt;
  if (node->is(Kind::string)) return CameraChoice{node->string, node->where};
  if (!node->is(Kind::object)) {
    reader.error(*node, "run-type", with_place("camera must be a name or an object", *node));
    return std::nullopt;
  }
  std::optional<Camera> camera = read_camera(reader, *node);
  if (!camera) return std::nullopt;
  return CameraChoice{std::move(*camera), node->where};
}

nlohmann::ordered_json to_json(const Node& node) {
  switch (node.kind) {
    case Kind::boolean:
      return node.boolean;
    case Kind::integer:
      return node.integer;
    case Kind::number:
      return node.number;
    case Kind::string:
      return node.string;
    case Kind::array: {
      auto list = nlohmann::ordered_json::array();
      for (const Node& item : node.items) list.push_back(to_json(item));
      return list;
    }
    case Kind::object: {
      auto object = nlohmann::ordered_json::object();
      for (const json::Member& member : node.members) object[member.key] = to_json(member.value);
      return object;
    }
    case Kind::null:
      break;
  }
  return nullptr;
}

std::vector<std::pair<std::string, std::string>> read_set(Reader& reader, const Node* node) {
  std::vector<std::pair<std::string, std::string>> set;
  if (node == nullptr) return set;
  if (!node->is(Kind::object)) {
    reader.error(*node, "run-type", with_place("set must be an object of \"pass.parameter\": value", *node));
    return set;
  }
  for (const json::Member& member : node->members) {
    if (member.key.find('.') == std::string::npos) {
      reader.error(member.value, "run-range", "\"" + member.key + "\" does not name a parameter",
                   "write \"pass.parameter\"");
    }
    set.emplace_back(member.key, to_json(member.value).dump());
  }
  return set;
}

}  // namespace

RunFile read_run_file(const std::string& path) {
  Diagnostics diagnostics;
  const json::Node root = json::parse_file(path, diagnostics);
  RunFile run;
  Reader reader(diagnostics);
  // A file that cannot be parsed has said so already.
  if (root.is(Kind::null) && diagnostics.has_errors()) throw BadInput(std::move(diagnostics));
  if (reader.object(root, "a run file",
                    {"$schema", "scene", "camera", "lights", "sky", "surfaces", "size", "pipeline", "set"})) {
    const fs::path folder = fs::path(path).parent_path();
    run.scene = read_path(reader, root.find("scene"), "scene", folder);
    run.pipeline = read_path(reader, root.find("pipeline"), "pipeline", folder);
    // A bare name that is not beside the run file is that of a shipped pipeline.
    std::error_code ignored;
    if (!run.pipeline.empty() && !fs::exists(run.pipeline, ignored)) run.pipeline = root.find("pipeline")->string;
    run.camera = read_camera_choice(reader, root.find("camera"));
    run.lights = read_lights(reader, root.find("lights"));
    if (const json::Node* sky = root.find("sky")) run.sky = read_sky_choice(reader, *sky, folder);
    run.surfaces = read_surfaces(reader, root.find("surfaces"));
    run.size = read_size(reader, root.find("size"));
    run.set = read_set(reader, root.find("set"));
  }
  if (diagnostics.has_errors()) throw BadInput(std::move(diagnostics));
  return run;
}

CameraChoice parse_camera(const std::string& text) {
  const SourceLocation where{"--camera", 0, 0, ""};
  if (!text.starts_with('{')) return {text, where};
  Diagnostics diagnostics;
  const json::Node root = json::parse(text, "--camera", diagnostics);
  Reader reader(diagnostics);
  std::optional<Camera> camera;
  if (!diagnostics.has_errors()) camera = read_camera(reader, root);
  if (diagnostics.has_errors() || !camera) throw BadInput(std::move(diagnostics));
  return {std::move(*camera), where};
}

}  // namespace loom::scene
