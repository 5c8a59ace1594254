// Its struct is wrong and it has no stamp: the struct alone must be enough to refuse it before its C++ runs.
#include <cstdlib>

#include "loom/plugin.h"

namespace {
void never_called(loom::Registry& /*registry*/) { std::abort(); }
}  // namespace

extern "C" __attribute__((visibility("default"))) const loom::LoomPlugin* loom_plugin() {
  static constexpr loom::LoomPlugin plugin{loom::plugin_abi + 41, sizeof(loom::LoomPlugin), LOOM_BUILD_TAG, "wrong_abi",
                                           &never_called};
  return &plugin;
}
