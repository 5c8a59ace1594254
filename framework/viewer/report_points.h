#pragma once
// The points of a report that `loom measure` wrote.
#include <string>
#include <vector>

#include <glm/vec2.hpp>

namespace loom::viewer {

struct ReportPoint {
  std::string scene, label;       ///< label: pipeline and what was set
  double gpu_ms = 0, relmse = 0;  ///< of a frame with all its samples; of hdr
  glm::ivec2 size{0};
  int samples = 1;
  bool front = false;  ///< nothing else of its scene is better in both
};

struct Report {
  std::string file;
  std::vector<std::string> scenes;  ///< in the order in which the report has them
  std::vector<ReportPoint> points;  ///< those that were measured
};

/// The report.json that a path means: itself, or the one in a folder; empty where it means none.
std::string report_file(const std::string& path);
/// Throws Error naming the file where it is no report.
Report load_report(const std::string& path);

}  // namespace loom::viewer
