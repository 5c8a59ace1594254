#include "plugins/library.h"

#include <dlfcn.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace loom::plugins {
namespace {

const char* const rebuild_hint = "rebuild it against this Lightloom: find_package(Loom) and loom_add_pass()";

std::string to_string(const Version& version) {
  return "ABI " + std::to_string(version.abi) + ", build " + version.build_tag;
}

std::string bound(const char* text) { return text == nullptr ? "(none)" : text; }

/// False, with the reason in `diagnostics`, where the two cannot share C++ objects.
bool compatible(const std::string& path, const Version& theirs, Diagnostics& diagnostics) {
  const Version ours = own_version();
  if (theirs.abi != ours.abi) {
    diagnostics.error(
        "plugin-abi",
        "made for plugin ABI " + std::to_string(theirs.abi) + ", this Lightloom has ABI " + std::to_string(ours.abi),
        {.file = path}, rebuild_hint);
    return false;
  }
  if (theirs.build_tag != ours.build_tag) {
    diagnostics.error(
        "plugin-build",
        "built as " + theirs.build_tag + ", this Lightloom as " + ours.build_tag + "; C++ objects cannot be shared",
        {.file = path}, rebuild_hint);
    return false;
  }
  return true;
}

/// The last error of dlopen() or dlsym().
std::string dl_error() { return bound(dlerror()); }

}  // namespace

Version own_version() { return {.abi = plugin_abi, .build_tag = LOOM_BUILD_TAG}; }

std::optional<Version> stamped_version(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t at = bytes.find(PluginStamp::marker);
  if (at == std::string::npos || bytes.size() - at < sizeof(PluginStamp)) return std::nullopt;
  PluginStamp stamp;
  std::memcpy(&stamp, bytes.data() + at, sizeof(stamp));
  return Version{.abi = stamp.abi, .build_tag = {stamp.build_tag, strnlen(stamp.build_tag, sizeof(stamp.build_tag))}};
}

std::optional<Library> open_library(const std::string& path, Diagnostics& diagnostics) {
  const std::optional<Version> stamped = stamped_version(path);
  if (stamped && !compatible(path, *stamped, diagnostics)) return std::nullopt;

  // NOW: a missing symbol shows here, not in the middle of a frame. LOCAL: plugins do not see each other's symbols.
  std::shared_ptr<void> handle(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* library) {
    if (library != nullptr) dlclose(library);
  });
  if (!handle) {
    diagnostics.error("plugin-load",
                      "the dynamic linker says: " + dl_error() +
                          " (plugin: " + (stamped ? to_string(*stamped) : std::string("version unknown")) +
                          "; this Lightloom: " + to_string(own_version()) + ")",
                      {.file = path}, "link what it needs, or rebuild it with loom_add_pass()");
    return std::nullopt;
  }
  using Entry = const LoomPlugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(handle.get(), "loom_plugin"));
  if (entry == nullptr) {
    diagnostics.error("plugin-symbol", "has no loom_plugin(): " + dl_error(), {.file = path},
                      "a plugin is made by the macro LOOM_PLUGIN; other libraries do not belong in this folder");
    return std::nullopt;
  }
  const LoomPlugin* plugin = entry();
  if (plugin == nullptr) {
    diagnostics.error("plugin-symbol", "loom_plugin() returned nothing", {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  // Only `abi` and `struct_bytes` lie at the same place in every version: check them before reading further.
  if (plugin->abi == plugin_abi && plugin->struct_bytes != sizeof(LoomPlugin)) {
    diagnostics.error("plugin-abi",
                      "its LoomPlugin struct has " + std::to_string(plugin->struct_bytes) +
                          " bytes, this Lightloom's has " + std::to_string(sizeof(LoomPlugin)) + " (both say ABI " +
                          std::to_string(plugin_abi) + ")",
                      {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  const bool same_abi = plugin->abi == plugin_abi;
  if (!compatible(path, {.abi = plugin->abi, .build_tag = same_abi ? bound(plugin->build_tag) : ""}, diagnostics)) {
    return std::nullopt;
  }
  if (plugin->name == nullptr || plugin->add_to == nullptr) {
    diagnostics.error("plugin-symbol", "its LoomPlugin struct lacks a name or add_to", {.file = path}, rebuild_hint);
    return std::nullopt;
  }
  return Library{.handle = std::move(handle), .plugin = plugin};
}

}  // namespace loom::plugins
