#pragma once
// Running a sweep: each point in a process of its own, results kept in a folder. What measure and tune share.
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/session.h"
#include "measure/sweep/expand.h"
#include "measure/sweep/result.h"
#include "measure/sweep/scene_report.h"
#include "measure/sweep/sweep.h"

namespace loom::cli {

/// What the command line may say in place of the sweep file.
struct SweepArguments {
  std::string sweep, out, references, size;
  std::vector<std::string> scenes;
  std::optional<int> samples, frames, seeds;
  std::optional<unsigned> spp;
  bool dynamic = false, no_flicker = false;
};
void add_sweep_options(CLI::App& command, SweepArguments& arguments);
/// The file, with what the command line puts in its place.
measure::Sweep load_sweep(const SweepArguments& arguments);

class SweepRun {
 public:
  /// Makes the folder. Throws BadInput.
  SweepRun(const SweepArguments& arguments, const Session& session);

  [[nodiscard]] const measure::Sweep& sweep() const { return sweep_; }
  [[nodiscard]] const std::vector<measure::Point>& points() const { return points_; }
  [[nodiscard]] const std::vector<measure::SceneReport>& scenes() const { return scenes_; }
  [[nodiscard]] std::string points_folder() const;

  /// The command line that measures this point again, behind `loom`.
  [[nodiscard]] std::vector<std::string> command(const std::string& key) const;

  /// References and floors of the scenes of these points; they are what takes long, and every point needs one.
  void stage(const std::vector<measure::Point>& points);
  /// The scenes as the folder has them, without making any.
  void read_scenes() { scenes_ = measure::read_scene_reports(arguments_.out); }
  /// The kept result, where there is one of today's scene, pipeline and program that did not fail. After stage().
  std::optional<measure::Result> kept(const measure::Point& point);
  /// In a process of its own; a failure is a result too. After stage().
  measure::Result measure_apart(const measure::Point& point);
  /// In this process. Throws where it fails.
  void measure_here(const measure::Point& point) const;

 private:
  std::string content_of(const measure::Point& point);

  const SweepArguments& arguments_;
  const Session& session_;
  Registry registry_;
  measure::Sweep sweep_;
  std::vector<measure::Point> points_;
  std::vector<std::string> shader_roots_;
  std::string truth_folder_;
  std::vector<measure::SceneReport> scenes_;
  std::map<std::size_t, std::string> truth_ids_;                         ///< by scene
  std::map<std::pair<std::size_t, std::size_t>, std::string> contents_;  ///< by scene and entry
};

}  // namespace loom::cli
