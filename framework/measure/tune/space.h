#pragma once
// From a sweep's points to what a search walks through, and from what it found to a pipeline.
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "loom/export.h"
#include "measure/sweep/result.h"
#include "measure/tune/search.h"

namespace loom::measure {

/// One a result or description, in its order; ranks are taken among the values that stand in `points`.
LOOM_API std::vector<Candidate> candidates_of(const std::vector<Result>& points);

/// A pipeline file for `path`'s folder: extends the measured one, sets what was set. `measured` says at what it was
/// measured.
LOOM_API nlohmann::ordered_json pipeline_of(const Result& result, const std::string& path,
                                            nlohmann::ordered_json measured);

}  // namespace loom::measure
