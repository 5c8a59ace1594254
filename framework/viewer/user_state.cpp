#include "viewer/user_state.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "loom/diagnostic.h"

namespace loom::viewer {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path file() {
  const std::string dir = made_state_dir();
  return dir.empty() ? fs::path() : fs::path(dir) / "view.json";
}

Json vector(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
glm::dvec3 vector(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

UserState parse(const Json& json) {
  UserState state;
  state.size = {json.at("size").at(0).get<int>(), json.at("size").at(1).get<int>()};
  state.size = glm::clamp(state.size, glm::ivec2(320, 240), glm::ivec2(16384));
  state.position = {json.at("position").at(0).get<int>(), json.at("position").at(1).get<int>()};
  state.font_scale = std::clamp(json.at("font_scale").get<float>(), .5f, 4.f);
  for (const auto& [scene, list] : json.at("bookmarks").items()) {
    for (const Json& item : list) {
      Bookmark mark{.name = item.at("name").get<std::string>(), .camera = {}};
      mark.camera.eye = vector(item.at("eye"));
      mark.camera.target = vector(item.at("target"));
      mark.camera.up = vector(item.at("up"));
      mark.camera.yfov_rad = item.at("yfov_rad").get<double>();
      state.bookmarks[scene].push_back(std::move(mark));
    }
  }
  return state;
}

}  // namespace

std::string made_state_dir() {
  const std::string dir = state_dir();
  std::error_code error;
  if (!dir.empty()) fs::create_directories(dir, error);
  return error ? std::string() : dir;
}

UserState load_user_state() {
  std::ifstream in(file());
  if (!in) return {};
  try {
    return parse(Json::parse(in));
  } catch (const Json::exception&) {
    return {};
  }
}

void save_user_state(const UserState& state) {
  const fs::path path = file();
  if (path.empty()) return;
  Json json{{"size", {state.size.x, state.size.y}},
            {"position", {state.position.x, state.position.y}},
            {"font_scale", state.font_scale},
            {"bookmarks", Json::object()}};
  for (const auto& [scene, marks] : state.bookmarks)
    for (const Bookmark& mark : marks)
      json["bookmarks"][scene].push_back({{"name", mark.name},
                                          {"eye", vector(mark.camera.eye)},
                                          {"target", vector(mark.camera.target)},
                                          {"up", vector(mark.camera.up)},
                                          {"yfov_rad", mark.camera.yfov_rad}});
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace);
  try {
    write_file_atomic(path.string(), std::as_bytes(std::span(text)));
  } catch (const Error&) {
    return;  // a read-only home is no reason to complain at the end of a session
  }
}

}  // namespace loom::viewer
