#pragma once
// The loom program, run as a user would run it.
#include <string>
#include <vector>

namespace loom::test {

struct ProcessResult {
  int exit_code = 0;  ///< 128 + n where signal n ended it
  std::string out, err;
};

/// Runs `program` (a path) and waits for it. Throws std::runtime_error where it cannot be started.
ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments);

/// build/bin/loom. The test's folder needs add_dependencies(test_<folder> loom_cli).
ProcessResult run_loom(const std::vector<std::string>& arguments);

}  // namespace loom::test
