#pragma once
// Stress cases in processes of their own: a crash or a hang is a result like any other.
#include <functional>
#include <vector>

#include "measure/stress.h"
#include "plugins/loader.h"

namespace loom::cli {

/// Runs the cases in order and hands over each result. A child process takes one after the other; the case in which it
/// ends or hangs is broken or skipped, and another child goes on with the next. The calling process must not have made
/// a GL context or started threads.
void run_in_children(const std::vector<const measure::StressCase*>& cases, const Registry& registry,
                     const plugins::SearchPath& search, const measure::StressLimits& limits, double seconds,
                     const std::function<void(const measure::StressCase&, const measure::StressResult&)>& done);

}  // namespace loom::cli
