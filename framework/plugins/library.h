#pragma once
// One shared library on its way to become a plugin: what it says about itself, loading, the C struct.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/plugin.h"

namespace loom::plugins {

/// What two binaries must agree on.
struct Version {
  std::uint32_t abi = 0;
  std::string build_tag;
};
/// Of this Lightloom.
Version own_version();
/// Of the plugin in `path`, read from the file without loading it; empty where it has no stamp.
LOOM_API std::optional<Version> stamped_version(const std::string& path);

struct Library {
  std::shared_ptr<void> handle;  ///< dlclose when the last owner lets go
  const LoomPlugin* plugin = nullptr;
};
/// Checks the stamp, loads, finds loom_plugin(), checks the struct. Empty where the file is refused: the reason is in
/// `diagnostics`.
/// `copy`: of a copy in the folder for temporary files, which is removed again at once.
std::optional<Library> open_library(const std::string& path, bool copy, Diagnostics& diagnostics);

}  // namespace loom::plugins
