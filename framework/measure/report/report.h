#pragma once
// The report of a sweep: a folder that opens in a browser from disk.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "loom/export.h"
#include "measure/sweep/result.h"
#include "measure/sweep/scene_report.h"
#include "measure/sweep/sweep.h"

namespace loom::measure {

struct ReportData {
  std::string folder;
  const Sweep& sweep;
  std::vector<Result> results;  ///< measured ones and failures
  std::vector<SceneReport> scenes;
  std::size_t expected = 0;  ///< points that the sweep has
  std::string version;       ///< of the program
  /// The words behind `loom` that measure the point of a key again.
  std::function<std::vector<std::string>(const std::string& key)> command;
};

/// A reference is refused as a measure where its own relMSE is not ten times below that of the best method.
inline constexpr double truth_margin = 10;
struct RefusedTruth {
  std::string scene, best;  ///< best: the pipeline that is too good for it
  double noise = 0, error = 0;
  std::uint64_t enough_spp = 0;  ///< samples a pixel that would do
};
LOOM_API std::vector<RefusedTruth> refused_truths(const ReportData& data);

/// Three digits, for people.
LOOM_API std::string number_text(double value);

/// Writes index.html with what it loads, report.json, report.csv and report.md beside it.
LOOM_API void write_report(const ReportData& data);

}  // namespace loom::measure
