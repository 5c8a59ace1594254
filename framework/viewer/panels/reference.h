#pragma once
// The truth beside the picture: how far it has come, the errors of the pipeline, and where others stand.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "loom/gpu.h"
#include "viewer/panels/pareto.h"
#include "viewer/reference_worker.h"

namespace loom::viewer {

struct Ui;

class ReferencePanel {
 public:
  void draw(Ui& ui);
  /// Starts, follows and feeds the tracer; once a loop, whether or not the panel is seen. True where something is new.
  bool follow(Ui& ui);
  [[nodiscard]] const ReferenceState& state() const { return state_; }
  [[nodiscard]] const std::vector<MeasuredPoint>& points() const { return points_; }
  bool on = false;
  ParetoPlot plot;

 private:
  void show(const ReferenceState& state);

  ReferenceWorker worker_;
  ReferenceState state_;
  std::vector<MeasuredPoint> points_;
  std::unique_ptr<Texture> truth_, heat_;
  std::uint64_t view_ = 0, picture_ = 0;
  std::string pipeline_of_picture_;
};

}  // namespace loom::viewer
