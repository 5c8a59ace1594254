#pragma once
// loom, started again: what must not share a process with anything before it.
#include <string>
#include <vector>

namespace loom::cli {

struct ChildResult {
  int exit_code = 0;    ///< 128 + n where signal n ended it
  std::string message;  ///< what it wrote to stderr
};

/// Runs this program with these arguments and waits for it. Throws Error where it cannot be started.
ChildResult run_self(const std::vector<std::string>& arguments);

}  // namespace loom::cli
