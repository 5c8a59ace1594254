// Apart from the rest: the commit changes with every build.
#include "cli/commit.h"
#include "cli/session.h"

namespace loom::cli {

std::string program_version() {
  const std::string commit = LOOM_COMMIT;
  return std::string("loom ") + LOOM_VERSION + (commit.empty() ? "" : " (" + commit + ")");
}

}  // namespace loom::cli
