#include "measure/sweep/truth.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <span>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "reference/film.h"
#include "reference/path_tracer.h"

namespace loom::measure {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr double epsilon = 1e-2;  // of relMSE

std::string picture_id(const scene::Setup& setup, glm::ivec2 size) {
  return fmt::format("{:016x}", reference::identify(setup.scene, setup.camera, size, {}).scene);
}

using Steps = std::vector<Truth::Step>;

/// How the error fell while the picture was traced, whatever the target; beside the accumulation.
void write_log(const std::string& path, const Steps& steps) {
  Json json = {{"version", 1}};
  Json& list = json["convergence"] = Json::array();
  for (const Truth::Step& s : steps) list.push_back({{"spp", s.spp}, {"seconds", s.seconds}, {"relmse", s.relmse}});
  const std::string text = json.dump(2) + "\n";
  write_file_atomic(path, std::as_bytes(std::span(text)));
}

/// Empty where there is none: the curve is then drawn from where it goes on.
Steps read_log(const std::string& path) {
  Steps steps;
  std::ifstream in(path);
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object() || !json.contains("convergence")) return steps;
  for (const Json& s : json["convergence"]) {
    steps.push_back({.spp = s.value("spp", 0U), .seconds = s.value("seconds", 0.), .relmse = s.value("relmse", 0.)});
  }
  return steps;
}

void trace(const std::string& film_path, const std::string& exr, const std::string& log, const scene::Setup& setup,
           glm::ivec2 size, const TruthTarget& target, const std::function<bool(const reference::Progress&)>& report) {
  const reference::Options options;
  reference::Film film = reference::open_film(
      film_path, size, reference::identify(setup.scene, setup.camera, size, options), options.seed);
  const glm::dvec3 origin = setup.camera.eye;
  const reference::PathTracer tracer(setup.scene, origin, options);
  Steps steps = read_log(log);
  const double before = film.seconds;
  const auto note_step = [&](const reference::Progress& p) {
    if (p.noise && (steps.empty() || p.measured_at > steps.back().spp)) {
      steps.push_back({.spp = p.measured_at, .seconds = before + p.seconds, .relmse = *p.noise * *p.noise});
    }
    return !report || report(p);
  };
  reference::run(tracer, film, reference::view_of(setup.camera, setup.scene, size, origin),
                 {.samples = target.spp, .noise = target.noise}, {.path = film_path}, note_step);
  write_log(log, steps);
  write_exr(exr, film.layers());  // last: where it is, all is
}

void measure_errors(Truth& truth) {
  const Layer radiance = find_layer(truth.file, "RGB"), spread = find_layer(truth.file, "stderr");
  const Layer albedo = find_layer(truth.file, "albedo"), indirect = find_layer(truth.file, "indirect");
  const Layer bounce = find_layer(truth.file, "bounce");
  const auto relative = [](double difference, double value) {
    return difference * difference / (value * value + epsilon);
  };
  double count = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < radiance.pixels(); ++i) {
      const auto at = [&](const Layer& layer) { return static_cast<double>(layer.planes[c][i]); };
      const double reflected = at(albedo) / std::numbers::pi;
      truth.noise += relative(at(spread), at(radiance));
      truth.without_indirect.hdr += relative(reflected * at(indirect), at(radiance));
      truth.without_indirect.indirect += relative(at(indirect), at(indirect));
      truth.without_indirect.bounce += relative(at(bounce), at(bounce));
      ++count;
    }
  }
  TruthErrors& without = truth.without_indirect;
  for (double* sum : {&truth.noise, &without.hdr, &without.indirect, &without.bounce}) {
    *sum /= count;
  }
}

}  // namespace

std::string default_truth_folder() { return (fs::path(cache_dir()) / "references").string(); }

std::string truth_id(const scene::Setup& setup, glm::ivec2 size, const TruthTarget& target) {
  return picture_id(setup, size) +
         (target.spp ? fmt::format("-{}spp", *target.spp) : fmt::format("-noise{:g}", target.noise.value_or(0)));
}

Truth obtain_truth(const std::string& folder, const scene::Setup& setup, glm::ivec2 size, const TruthTarget& target,
                   const std::function<bool(const reference::Progress&)>& report) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw BadInput("no folder for references: cannot make " + folder + " (" + error.message() + ")");
  Truth truth;
  truth.id = truth_id(setup, size, target);
  const std::string exr = (fs::path(folder) / (truth.id + ".exr")).string();
  const std::string picture = (fs::path(folder) / picture_id(setup, size)).string();
  const std::string log = picture + ".json";
  if (!fs::exists(exr)) trace(picture + ".film", exr, log, setup, size, target, report);
  truth.file = read_image(exr);
  truth.spp = static_cast<std::uint32_t>(std::strtoul(truth.file.image.attributes["loom:spp"].c_str(), nullptr, 10));
  for (const Truth::Step& step : read_log(log)) {
    if (step.spp > truth.spp) break;
    truth.convergence.push_back(step);
    truth.seconds = step.seconds;
  }
  measure_errors(truth);
  return truth;
}

}  // namespace loom::measure
