#pragma once
// Seeded random pipelines, together with what they mean, for property tests and the benchmark.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "loom/registry.h"

namespace loom::test {

struct RandomGraph {
  std::string text;                                       ///< the pipeline
  std::vector<std::string> names;                         ///< passes in file order
  std::vector<std::string> roots;                         ///< passes that outputs name, and those with side effects
  std::map<std::string, std::vector<std::string>> reads;  ///< pass -> passes it depends on, history included
  std::vector<std::pair<std::string, std::string>> must_precede;  ///< (before, after) in one frame
};

RandomGraph random_graph(unsigned seed, int passes);
/// The pass types those pipelines use.
Registry random_registry();

}  // namespace loom::test
