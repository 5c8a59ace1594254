// Measurements of scenes in the user's cache: one JSON file a scene, named by its content hash.
#include <array>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "core/log.h"
#include "loom/diagnostic.h"
#include "reference/analysis.h"

namespace loom::reference {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

/// Raised whenever what is measured changes: older entries are measured again.
constexpr int cache_version = 1;

fs::path path_of(std::uint64_t content_hash) {
  const std::string dir = cache_dir();
  return dir.empty() ? fs::path() : fs::path(dir) / fmt::format("scene-{:016x}.json", content_hash);
}

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

glm::dvec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::array<double, SceneMeasurements::bands> bands_of(const Json& json) {
  std::array<double, SceneMeasurements::bands> values{};
  if (json.size() != values.size()) throw Error("another number of bands");
  for (std::size_t i = 0; i < values.size(); ++i) values.at(i) = json.at(i).get<double>();
  return values;
}

}  // namespace

std::optional<SceneMeasurements> cached_measurements(std::uint64_t content_hash) {
  const fs::path path = path_of(content_hash);
  std::ifstream file(path);
  if (path.empty() || !file) return std::nullopt;
  try {
    const Json json = Json::parse(file);
    if (json.at("version").get<int>() != cache_version) return std::nullopt;
    return SceneMeasurements{.lit_min = vector_of(json.at("lit_min")),
                             .lit_max = vector_of(json.at("lit_max")),
                             .seen_min = vector_of(json.at("seen_min")),
                             .seen_max = vector_of(json.at("seen_max")),
                             .thinnest_occluder = json.at("thinnest_occluder").get<double>(),
                             .sheets = json.at("sheets").get<double>(),
                             .radiance = bands_of(json.at("radiance")),
                             .visibility = bands_of(json.at("visibility")),
                             .probes = json.at("probes").get<int>()};
  } catch (const std::exception& error) {
    log().debug("{} is damaged and will be replaced: {}", path.string(), error.what());
    return std::nullopt;
  }
}

void cache_measurements(std::uint64_t content_hash, const SceneMeasurements& m) {
  const fs::path path = path_of(content_hash);
  if (path.empty()) return;
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  const std::string text = Json{{"version", cache_version},
                                {"lit_min", json_of(m.lit_min)},
                                {"lit_max", json_of(m.lit_max)},
                                {"seen_min", json_of(m.seen_min)},
                                {"seen_max", json_of(m.seen_max)},
                                {"thinnest_occluder", m.thinnest_occluder},
                                {"sheets", m.sheets},
                                {"radiance", m.radiance},
                                {"visibility", m.visibility},
                                {"probes", m.probes}}
                               .dump(1) +
                           '\n';
  try {
    write_file_atomic(path.string(), std::as_bytes(std::span(text)));
  } catch (const std::exception& error) {
    log().warn("what was measured of the scene is not kept: {}", error.what());
  }
}

}  // namespace loom::reference
