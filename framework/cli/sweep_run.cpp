#include "cli/sweep_run.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <system_error>

#include "cli/child.h"
#include "cli/progress.h"
#include "measure/sweep/measure_point.h"
#include "measure/sweep/truth.h"

namespace loom::cli {

namespace fs = std::filesystem;
using measure::Point;
using measure::Result;

void add_sweep_options(CLI::App& command, SweepArguments& arguments) {
  command.add_option("--size", arguments.size, "Pixels of every picture, in place of the sweep's")->type_name("WxH");
  command.add_option("--samples", arguments.samples, "Samples a pixel, in place of the sweep's")
      ->check(CLI::Range(1, 65536));
  command.add_option("--frames", arguments.frames, "Timed frames, in place of the sweep's")
      ->check(CLI::Range(1, 100000));
  command.add_option("--seeds", arguments.seeds, "Pictures with different seeds, in place of the sweep's")
      ->check(CLI::Range(1, 1000));
  command.add_option("--spp", arguments.spp, "Paths a pixel of the reference, in place of the sweep's")
      ->check(CLI::Range(16, 1 << 28));
  command.add_flag("--dynamic", arguments.dynamic, "Make everything anew in every frame, as if everything moved");
  command
      .add_option("--references", arguments.references, "Folder where references are kept (default: the user's cache)")
      ->type_name("DIR");
}

measure::Sweep load_sweep(const SweepArguments& arguments) {
  measure::Sweep sweep = measure::read_sweep(arguments.sweep, {.scene = find_scene, .pipeline = find_pipeline});
  if (!arguments.scenes.empty()) sweep.scenes.clear();
  for (const std::string& name : arguments.scenes) {
    sweep.scenes.push_back({.name = name, .path = find_scene(name), .camera = {}, .size = {}});
  }
  measure::Settings& settings = sweep.settings;
  if (!arguments.size.empty()) {
    settings.size = parse_size(arguments.size);
    for (measure::SweepScene& scene : sweep.scenes) scene.size.reset();
  }
  settings.samples = arguments.samples.value_or(settings.samples);
  settings.frames = arguments.frames.value_or(settings.frames);
  settings.seeds = arguments.seeds.value_or(settings.seeds);
  if (arguments.spp) settings.truth = {.spp = arguments.spp, .noise = {}};
  if (arguments.dynamic) settings.keep_static = false;
  if (arguments.no_flicker) settings.flicker.reset();
  return sweep;
}

SweepRun::SweepRun(const SweepArguments& arguments, const Session& session)
    : arguments_(arguments),
      session_(session),
      registry_(load_registry(session)),
      sweep_(load_sweep(arguments)),
      points_(measure::expand(sweep_, registry_)),
      shader_roots_(plugins::shader_roots(session.search())),
      truth_folder_(arguments.references.empty() ? measure::default_truth_folder() : arguments.references) {
  std::error_code error;
  fs::create_directories(points_folder(), error);
  if (error) throw bad_usage("cannot make the folder " + points_folder() + " (" + error.message() + ")");
}

std::string SweepRun::points_folder() const { return (fs::path(arguments_.out) / "points").string(); }

void SweepRun::stage(const std::vector<Point>& points) {
  std::set<std::size_t> used;
  for (const Point& point : points) used.insert(point.scene);
  for (const std::size_t index : used) {
    const measure::SweepScene& scene = sweep_.scenes[index];
    Progress progress("reference of " + scene.name + ", thousandths", 1000);
    scenes_.push_back(measure::report_scene({.scene = scene,
                                             .settings = sweep_.settings,
                                             .size = measure::size_of(sweep_, scene),
                                             .registry = registry_,
                                             .shader_roots = shader_roots_,
                                             .truth_folder = truth_folder_,
                                             .folder = arguments_.out},
                                            [&](const reference::Progress& p) {
                                              progress.show(static_cast<std::uint64_t>(1000 * p.fraction));
                                              return true;
                                            }));
    truth_ids_[index] = scenes_.back().truth;
  }
}

std::string SweepRun::content_of(const Point& point) {
  std::string& content = contents_[{point.scene, point.entry}];
  if (content.empty()) {
    content = measure::content_of(sweep_, point, truth_ids_.at(point.scene), shader_roots_);
  }
  return content;
}

std::optional<Result> SweepRun::kept(const Point& point) {
  std::optional<Result> result = measure::read_result(arguments_.out, point.key);
  if (!result || !result->failure.empty() || result->content != content_of(point)) return std::nullopt;
  return result;
}

std::vector<std::string> SweepRun::command(const std::string& key) const {
  std::vector<std::string> words = {"measure", arguments_.sweep, "-o", arguments_.out, "--point", key};
  const auto add = [&](const char* option, const std::string& value) { words.insert(words.end(), {option, value}); };
  if (!arguments_.references.empty()) add("--references", arguments_.references);
  for (const std::string& folder : session_.plugin_dirs) add("--plugins", folder);
  for (const std::string& scene : arguments_.scenes) add("--scene", scene);
  if (!arguments_.size.empty()) add("--size", arguments_.size);
  if (arguments_.samples) add("--samples", std::to_string(*arguments_.samples));
  if (arguments_.frames) add("--frames", std::to_string(*arguments_.frames));
  if (arguments_.seeds) add("--seeds", std::to_string(*arguments_.seeds));
  if (arguments_.spp) add("--spp", std::to_string(*arguments_.spp));
  if (arguments_.dynamic) words.emplace_back("--dynamic");
  if (arguments_.no_flicker) words.emplace_back("--no-flicker");
  return words;
}

Result SweepRun::measure_apart(const Point& point) {
  const ChildResult child = run_self(command(point.key));
  if (child.exit_code == 0) {
    if (auto result = measure::read_result(arguments_.out, point.key)) return *result;
  }
  // It failed, the others need not. What it said is part of the result.
  Result failed = measure::describe(sweep_, point);
  failed.truth = truth_ids_.at(point.scene);
  failed.content = content_of(point);
  failed.failure = child.message.empty() ? "it ended with code " + std::to_string(child.exit_code) : child.message;
  measure::write_result(arguments_.out, failed);
  return failed;
}

void SweepRun::measure_here(const Point& point) const {
  measure::write_result(arguments_.out, measure::measure_point({.sweep = sweep_,
                                                                .point = point,
                                                                .registry = registry_,
                                                                .shader_roots = shader_roots_,
                                                                .truth_folder = truth_folder_,
                                                                .pictures = points_folder(),
                                                                .version = program_version()}));
}

}  // namespace loom::cli
