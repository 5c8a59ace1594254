// Made for another ABI, as its stamp says: nothing of it may run, not even its static constructors.
#include <cstdlib>

#include "loom/plugin.h"

namespace {

struct Early {
  Early() { std::abort(); }
} early;

constexpr loom::PluginStamp other_abi() {
  loom::PluginStamp stamp = loom::make_plugin_stamp("Elbrus-1.0");
  stamp.abi += 7;
  return stamp;
}
__attribute__((used)) constexpr loom::PluginStamp stamp = other_abi();

}  // namespace
