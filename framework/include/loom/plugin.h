#pragma once
// The only C symbol of a plugin. It returns a plain struct, checked before any C++ of the plugin runs.
#include <cstdint>

#include "loom/export.h"
#include "loom/pass.h"      // IWYU pragma: export
#include "loom/registry.h"  // IWYU pragma: export

namespace loom {

/// Raised with every change of a public header that a compiled plugin could notice.
inline constexpr std::uint32_t plugin_abi = 1;

extern "C" struct LoomPlugin {
  std::uint32_t abi;
  std::uint32_t struct_bytes;
  const char* build_tag;  ///< compiler, standard library and sanitizers: what must agree to share C++ objects
  const char* name;
  void (*add_to)(loom::Registry&);
};

}  // namespace loom

/// LOOM_BUILD_TAG is given by loom_add_pass(), the same for framework and plugins of one build configuration.
#define LOOM_PLUGIN(plugin_name, registry)                                                                            \
  static void loom_add_to(loom::Registry& registry);                                                                  \
  extern "C" __attribute__((visibility("default"))) const loom::LoomPlugin* loom_plugin() {                           \
    static constexpr loom::LoomPlugin plugin{loom::plugin_abi, sizeof(loom::LoomPlugin), LOOM_BUILD_TAG, plugin_name, \
                                             &loom_add_to};                                                           \
    return &plugin;                                                                                                   \
  }                                                                                                                   \
  static void loom_add_to(loom::Registry& registry)
