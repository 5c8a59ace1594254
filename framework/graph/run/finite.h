#pragma once
// Counts the numbers that no pass may make.
#include <cstdint>
#include <vector>

#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "graph/run/storage.h"

namespace loom::graph {

/// Reads every output of the pass back; adds a report for each that holds negative or non-finite numbers.
void count_bad_numbers(const CompiledGraph& graph, const CompiledPass& pass, const Storage& storage,
                       std::uint64_t frame, std::vector<FiniteReport>& reports);

}  // namespace loom::graph
