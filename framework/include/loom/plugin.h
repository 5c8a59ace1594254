#pragma once
// The only C symbol of a plugin. It returns a plain struct, checked before any C++ of the plugin runs.
#include <cstddef>
#include <cstdint>
#include <string_view>

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

/// The same facts as plain bytes in the file, so that the loader can read them without loading it: a plugin of another
/// ABI is refused before its static constructors run, and one that dlopen() refuses can still name its version.
struct PluginStamp {
  static constexpr std::string_view marker = "loom-plugin-fact";
  char magic[16];
  std::uint32_t abi;
  char build_tag[108];  ///< cut off where it is longer
};
consteval PluginStamp make_plugin_stamp(std::string_view build_tag) {
  PluginStamp stamp{.magic = {}, .abi = plugin_abi, .build_tag = {}};
  for (std::size_t i = 0; i < PluginStamp::marker.size(); ++i) stamp.magic[i] = PluginStamp::marker[i];
  for (std::size_t i = 0; i < build_tag.size() && i + 1 < sizeof(stamp.build_tag); ++i) {
    stamp.build_tag[i] = build_tag[i];
  }
  return stamp;
}

}  // namespace loom

// NOLINTBEGIN(bugprone-macro-parentheses): a string literal and a parameter's name take none
/// LOOM_BUILD_TAG is given by loom_add_pass(), the same for framework and plugins of one build configuration.
#define LOOM_PLUGIN(plugin_name, registry)                                                                            \
  static void loom_add_to(loom::Registry& registry);                                                                  \
  __attribute__((used)) static constexpr loom::PluginStamp loom_stamp = loom::make_plugin_stamp(LOOM_BUILD_TAG);      \
  extern "C" __attribute__((visibility("default"))) const loom::LoomPlugin* loom_plugin() {                           \
    static constexpr loom::LoomPlugin plugin{loom::plugin_abi, sizeof(loom::LoomPlugin), LOOM_BUILD_TAG, plugin_name, \
                                             &loom_add_to};                                                           \
    return &plugin;                                                                                                   \
  }                                                                                                                   \
  static void loom_add_to(loom::Registry& registry)
// NOLINTEND(bugprone-macro-parentheses)
