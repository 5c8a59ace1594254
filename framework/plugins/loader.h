#pragma once
// Finds plugins, checks them, lets them register.
#include <string>
#include <vector>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/registry.h"

namespace loom::plugins {

struct SearchPath {
  std::vector<std::string> dirs;  ///< --plugins, in order; then LOOM_PLUGIN_PATH (colon-separated)
  bool installed = true;          ///< then the installation's own folder, relative to the loom library
  /// Load a copy of each file, under a name of its own: the file may then be replaced while it is in use, and loading
  /// it again gives the new code (hot reload).
  bool copies = false;
};

struct LoadedPlugin {
  std::string name, path;
};

/// Loads every *.so of the search path into `registry`. A plugin that is refused (codes `plugin-load`, `plugin-symbol`,
/// `plugin-abi`, `plugin-build`, `plugin-throws`, `duplicate-type`, `bundle-conflict`) is a diagnostic by name; the
/// others still load. Folders in order, files by name; a file reached twice is loaded once. A folder that was asked for
/// and cannot be read is a `plugin-dir`.
LOOM_API std::vector<LoadedPlugin> load_plugins(const SearchPath& search, Registry& registry, Diagnostics& diagnostics);

/// The files that load_plugins() looks at.
LOOM_API std::vector<std::string> plugin_files(const SearchPath& search);

/// Where shaders are: LOOM_SHADER_PATH (colon-separated), `shaders/` beside each plugin folder, the installation's own.
LOOM_API std::vector<std::string> shader_roots(const SearchPath& search);
/// The installation's data folder: pipelines/, configs/, shaders/.
LOOM_API std::string data_dir();

}  // namespace loom::plugins
