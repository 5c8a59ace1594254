#include "viewer/export.h"

#include <fmt/core.h>

#include <algorithm>

#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "viewer/values.h"

namespace loom::viewer {
namespace {

using Json = nlohmann::ordered_json;

Json vector(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json camera_object(const scene::Camera& camera, const glm::dvec3& origin) {
  return {{"eye", vector(camera.eye + origin)},
          {"target", vector(camera.target + origin)},
          {"up", vector(camera.up)},
          {"yfov_deg", glm::degrees(camera.yfov_rad)}};
}

Json light_object(const scene::Light& light, const glm::dvec3& origin) {
  constexpr const char* kinds[] = {"point", "spot", "directional"};
  Json object{{"type", kinds[static_cast<std::size_t>(light.kind)]}};
  if (!light.name.empty()) object["name"] = light.name;
  if (light.kind != scene::LightKind::directional) object["position"] = vector(light.position + origin);
  if (light.kind != scene::LightKind::point) object["direction"] = vector(light.direction);
  object["color"] = vector(glm::dvec3(light.intensity));
  object["intensity"] = 1;
  if (light.kind == scene::LightKind::spot) {
    object["inner_deg"] = glm::degrees(light.inner_rad);
    object["outer_deg"] = std::min(glm::degrees(light.outer_rad), 90.);
  }
  return object;
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string pipeline_text(const std::string& name, const std::string& base, const Settings& set) {
  Json passes = Json::object();
  for (const auto& [path, value] : set) {
    const std::size_t dot = path.find('.');
    Json parsed = Json::parse(value, nullptr, false);
    if (parsed.is_discarded()) parsed = value;  // --set takes bare words
    passes[path.substr(0, dot)]["params"][path.substr(dot + 1)] = std::move(parsed);
  }
  Json root{{"extends", base}, {"name", name}};
  if (!passes.empty()) root["passes"] = std::move(passes);
  return text_of(root);
}

std::string camera_json(const scene::Camera& camera, const glm::dvec3& origin) {
  return camera_object(camera, origin).dump();
}

std::string run_file_text(const std::string& scene, const std::vector<scene::Light>& lights, const std::string& sky,
                          const scene::Camera& camera, const glm::dvec3& origin) {
  Json root{{"scene", scene},
            {"camera", camera_object(camera, origin)},
            {"sky", Json::parse(sky)},
            {"lights", Json::array()}};
  for (const scene::Light& light : lights) root["lights"].push_back(light_object(light, origin));
  return text_of(root);
}

std::string command_text(const RenderCommand& command) {
  std::string text = "loom render";
  const auto add = [&](const std::string& word) { text += " " + shell_word(word); };
  if (!command.scene.empty()) add(command.scene);
  add("-p");
  add(command.pipeline);
  add("--size");
  add(fmt::format("{}x{}", command.size.x, command.size.y));
  if (!command.camera.empty()) {
    add("--camera");
    add(command.camera);
  }
  for (const auto& [path, value] : command.set) {
    add("--set");
    add(path + "=" + set_text(value));
  }
  if (command.frames > 1) add(fmt::format("--frames={}", command.frames));
  if (command.frames > 1) add(fmt::format("--dt={}", command.dt_s));
  for (const std::string& dir : command.plugin_dirs) {
    add("--plugins");
    add(dir);
  }
  return text + " -o view.png";
}

}  // namespace loom::viewer
