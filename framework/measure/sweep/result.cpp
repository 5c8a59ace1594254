#include "measure/sweep/result.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <span>

#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "loom/diagnostic.h"

namespace loom::measure {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double number(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Json spread_json(const Spread& spread) { return {{"median", spread.median}, {"p95", spread.p95}}; }
Spread spread_from(const Json& json) { return {json.at("median"), json.at("p95")}; }

Json error_json(const OutputError& error) {
  return {{"relmse", number(error.relmse)},
          {"ci95", {number(error.low), number(error.high)}},
          {"seed_sd", number(error.seed_sd)},
          {"mean_ratio", number(error.mean_ratio)},
          {"flip", error.flip ? number(*error.flip) : Json(nullptr)},
          {"non_finite", error.non_finite}};
}

OutputError error_from(const Json& json) {
  OutputError error;
  error.relmse = number(json.at("relmse"));
  error.low = number(json.at("ci95").at(0));
  error.high = number(json.at("ci95").at(1));
  error.seed_sd = number(json.at("seed_sd"));
  error.mean_ratio = number(json.at("mean_ratio"));
  if (json.at("flip").is_number()) error.flip = json.at("flip").get<double>();
  error.non_finite = json.at("non_finite");
  return error;
}

}  // namespace

Json to_json(const Result& r) {
  Json json = {{"version", 1},       {"key", r.key},           {"scene", r.scene},
               {"camera", r.camera}, {"pipeline", r.pipeline}, {"pipeline_path", r.pipeline_path}};
  Json& set = json["set"] = Json::object();
  for (const auto& [name, value] : r.set) set[name] = Json::parse(value);
  json["size"] = {r.size.x, r.size.y};
  json["samples"] = r.samples;
  json["frames"] = r.frames;
  json["seeds"] = r.seeds;
  json["static"] = r.keep_static;
  json["reference"] = r.truth;
  json["content"] = r.content;
  if (!r.failure.empty()) {
    json["failure"] = r.failure;
    return json;
  }
  Json& errors = json["error"] = Json::object();
  for (const auto& [output, error] : r.errors) errors[output] = error_json(error);
  json["no_indirect"] = r.no_indirect;
  json["frame"] = {{"wall_ms", spread_json(r.wall_ms)},
                   {"cpu_ms", spread_json(r.cpu_ms)},
                   {"gpu_ms", spread_json(r.gpu_ms)},
                   {"first_ms", r.first_ms},
                   {"anew_ms", r.anew_ms}};
  json["memory"] = {{"textures_bytes", r.bytes}, {"without_aliasing_bytes", r.bytes_without_aliasing}};
  json["flicker"] = r.flicker ? number(*r.flicker) : Json(nullptr);
  json["device"] = r.device;
  json["program"] = r.version;
  json["took"] = {{"load_s", r.load_s}, {"frames_s", r.frames_s}, {"rest_s", r.rest_s}};
  return json;
}

Result result_from(const Json& json, const std::string& file) {
  Result r;
  try {
    r.key = json.at("key");
    r.scene = json.at("scene");
    r.camera = json.at("camera");
    r.pipeline = json.at("pipeline");
    r.pipeline_path = json.at("pipeline_path");
    for (const auto& [name, value] : json.at("set").items()) r.set.emplace_back(name, value.dump());
    r.size = {json.at("size").at(0), json.at("size").at(1)};
    r.samples = json.at("samples");
    r.frames = json.at("frames");
    r.seeds = json.at("seeds");
    r.keep_static = json.at("static");
    r.truth = json.at("reference");
    r.content = json.at("content");
    r.failure = json.value("failure", "");
    if (!r.failure.empty()) return r;
    for (const auto& [output, error] : json.at("error").items()) r.errors[output] = error_from(error);
    r.no_indirect = json.at("no_indirect");
    const Json& frame = json.at("frame");
    r.wall_ms = spread_from(frame.at("wall_ms"));
    r.cpu_ms = spread_from(frame.at("cpu_ms"));
    r.gpu_ms = spread_from(frame.at("gpu_ms"));
    r.first_ms = frame.at("first_ms");
    r.anew_ms = frame.at("anew_ms");
    r.bytes = json.at("memory").at("textures_bytes");
    r.bytes_without_aliasing = json.at("memory").at("without_aliasing_bytes");
    if (json.at("flicker").is_number()) r.flicker = json.at("flicker").get<double>();
    r.device = json.at("device");
    r.version = json.at("program");
    const Json& took = json.at("took");
    r.load_s = took.at("load_s");
    r.frames_s = took.at("frames_s");
    r.rest_s = took.at("rest_s");
  } catch (const Json::exception& error) {
    throw BadInput(file + " holds no result of a measurement: " + error.what());
  }
  return r;
}

std::string result_path(const std::string& folder, const std::string& key) {
  return (std::filesystem::path(folder) / "points" / (key + ".json")).string();
}

void write_result(const std::string& folder, const Result& result) {
  const std::string text = to_json(result).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  write_file_atomic(result_path(folder, result.key), std::as_bytes(std::span(text)));
}

std::optional<Result> read_result(const std::string& folder, const std::string& key) {
  const std::string path = result_path(folder, key);
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  try {
    return result_from(Json::parse(in), path);
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const BadInput&) {
    return std::nullopt;
  }
}

}  // namespace loom::measure
