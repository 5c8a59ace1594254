#include "viewer/report_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "loom/diagnostic.h"
#include "measure/report/front.h"
#include "measure/sweep/result.h"

namespace loom::viewer {
namespace {

namespace fs = std::filesystem;

BadInput no_report(const std::string& file, const std::string& why) {
  Diagnostics diagnostics;
  diagnostics.error("no-report", file + " is no report: " + why, {},
                    "`loom measure SWEEP.json -o FOLDER` writes FOLDER/report.json");
  return BadInput(diagnostics);
}

/// Fronts by the axes of this plot, which are not those of every plot in the report.
void mark_fronts(Report& report) {
  for (const std::string& scene : report.scenes) {
    std::vector<ReportPoint*> group;
    std::vector<double> cost, error;
    for (ReportPoint& point : report.points)
      if (point.scene == scene) {
        group.push_back(&point);
        cost.push_back(point.gpu_ms);
        error.push_back(point.relmse);
      }
    const std::vector<bool> on = measure::pareto_front(cost, error);
    for (std::size_t i = 0; i < group.size(); ++i) group[i]->front = on[i];
  }
}

}  // namespace

std::string report_file(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    const fs::path inside = fs::path(path) / "report.json";
    return fs::exists(inside, error) ? inside.string() : std::string();
  }
  return fs::path(path).filename() == "report.json" ? path : std::string();
}

Report load_report(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw no_report(path, "it cannot be read");
  Report report{.file = path, .scenes = {}, .points = {}};
  try {
    const auto json = nlohmann::ordered_json::parse(in);
    for (const auto& item : json.at("points")) {
      const measure::Result r = measure::result_from(item, path);
      const double error = r.error("hdr");
      if (!r.failure.empty() || !std::isfinite(error) || !(r.gpu_ms.median > 0)) continue;
      ReportPoint point{.scene = r.scene, .label = r.pipeline, .gpu_ms = r.gpu_ms.median, .relmse = error};
      for (const auto& [param, value] : r.set) point.label += fmt::format(" {}={}", param, value);
      point.size = r.size;
      point.samples = r.samples;
      if (std::find(report.scenes.begin(), report.scenes.end(), r.scene) == report.scenes.end())
        report.scenes.push_back(r.scene);
      report.points.push_back(std::move(point));
    }
  } catch (const nlohmann::json::exception& error) {
    throw no_report(path, error.what());
  }
  if (report.points.empty()) throw no_report(path, "it has no measured point");
  mark_fronts(report);
  return report;
}

}  // namespace loom::viewer
