#pragma once
// The extremes: pipelines pushed to the ends of what they accept, and what must hold there. Generated from the
// pipelines and the declarations of their parameters, so that what is new is covered without anyone adding it.
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "graph/compile/compile.h"
#include "loom/export.h"
#include "loom/gpu.h"
#include "loom/registry.h"
#include "measure/stress_scenes.h"

namespace loom::measure {

/// One rendering of a case. `weight`: of its radiance in the sum that has to vanish. `shift`: pixels by which it is
/// moved to the left before it is added.
struct StressPart {
  View view;
  double weight = 1;
  int shift = 0;
  std::vector<graph::Override> set;  ///< after those of the case
};

/// The group of the cases that set all parameters of a pipeline at once.
inline constexpr const char* parameters_group = "all parameters at their ends";
/// The group of the cases that compare half floats with floats in the volumes of one pass.
inline constexpr const char* storage_group = "half floats in a volume";

/// One thing to try.
struct StressCase {
  std::string group;     ///< the row of the report: "parameter at an end", "units"
  std::string name;      ///< what is extreme: "rays = 4096", "×1e6"
  std::string pipeline;  ///< path
  glm::ivec2 size{16, 12};
  std::vector<graph::Override> set;
  int frames = 1;
  /// One: finite, not negative, under the furnace bound. More: their weighted sum must vanish too.
  std::function<std::vector<StressPart>()> parts;
  double tolerance = std::numeric_limits<double>::infinity();  ///< of the sum, relative L2 of hdr and of indirect
  bool bounded = true;  ///< no picture may pass the furnace bound, which else holds in the mean alone
  bool quick = false;   ///< belongs to the part that is run with the tests

  /// Stable and unique.
  [[nodiscard]] LOOM_API std::string id() const;
};

enum class StressOutcome {
  held,     ///< everything that must hold does
  refused,  ///< a clear error before the first frame
  broken,   ///< a fault
  skipped,  ///< more memory or time than it was given
};

struct StressResult {
  StressOutcome outcome = StressOutcome::held;
  std::string message;  ///< why it was refused or skipped, what broke
  double error = 0;     ///< relative L2 of the weighted sum, the larger of hdr's and indirect's
  double share = 0;     ///< brightest radiance over the furnace bound
  double saved = 0;     ///< planned bytes of the first part less those of the last
};

struct StressLimits {
  std::size_t bytes = std::size_t{512} << 20;  ///< plans that take more are skipped
};

/// Renders the parts of a case and judges them. Needs a current context; never throws for what a pipeline does.
LOOM_API StressResult run_stress(const StressCase& what, const Registry& registry, Device& device,
                                 const StressLimits& limits = {});

/// All cases of these pipelines (paths).
LOOM_API std::vector<StressCase> stress_cases(const std::vector<std::string>& pipelines, const Registry& registry);

}  // namespace loom::measure
