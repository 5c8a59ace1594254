#pragma once
// Results of the stress cases: one line of JSON each, so that a run can go on where it was cut off; and the report.
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "loom/export.h"
#include "measure/stress.h"

namespace loom::measure {

LOOM_API std::string to_line(const std::string& id, const StressResult& result);
/// Nothing where the line is cut short or no result.
LOOM_API std::optional<std::pair<std::string, StressResult>> from_line(const std::string& line);

/// What is known, kept in a file where one is named.
class LOOM_API StressLog {
 public:
  /// `path`: empty = in memory alone. Lines that cannot be read (a run was killed) are passed over.
  explicit StressLog(std::string path);
  [[nodiscard]] const StressResult* find(const std::string& id) const;
  /// Throws Error where the file cannot be written.
  void add(const StressCase& what, const StressResult& result);

 private:
  std::string path_;
  std::map<std::string, StressResult> results_;
};

/// Markdown: what was tried, how many, the precision that each pipeline keeps, what is broken, what was left out.
LOOM_API std::string stress_report(const std::vector<StressCase>& cases, const StressLog& log);

}  // namespace loom::measure
