#pragma once
// Error over cost: the pipelines that were open in this view, among the points of a published report.
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/report_points.h"

namespace loom::viewer {

/// What a pipeline came to in the open view.
struct MeasuredPoint {
  std::string pipeline;
  double gpu_ms = 0, relmse = 0;
};

class ParetoPlot {
 public:
  /// The row of widgets that loads a report and chooses its scene; `size`: of the live frame.
  void draw_controls(const std::string& open_scene, glm::ivec2 size);
  void draw_plot(const std::vector<MeasuredPoint>& live, const std::string& open) const;
  /// Throws Error. The scene whose name is that of the open one is chosen.
  void load(const std::string& path, const std::string& open_scene);
  [[nodiscard]] const std::optional<Report>& report() const { return report_; }
  [[nodiscard]] const std::string& scene() const { return scene_; }

 private:
  std::optional<Report> report_;
  std::string scene_, path_, failure_;
};

}  // namespace loom::viewer
