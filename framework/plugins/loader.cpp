#include "plugins/loader.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/data_dir.h"
#include "plugins/library.h"

namespace loom::plugins {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> paths_of_variable(const char* name) {
  const char* value = std::getenv(name);
  std::vector<std::string> paths;
  std::istringstream list(value == nullptr ? "" : value);
  for (std::string path; std::getline(list, path, ':');) {
    if (!path.empty()) paths.push_back(path);
  }
  return paths;
}

/// A folder to look into, and who asked for it.
struct Place {
  std::string dir;
  std::string asked_by;  ///< empty: nobody, it may be missing
};

std::vector<Place> places(const SearchPath& search) {
  std::vector<Place> list;
  for (const std::string& dir : search.dirs) list.push_back({dir, "--plugins"});
  for (const std::string& dir : paths_of_variable("LOOM_PLUGIN_PATH")) list.push_back({dir, "LOOM_PLUGIN_PATH"});
  if (search.installed) list.push_back({library_dir() + "/loom/passes", ""});
  return list;
}

/// The *.so of a folder by name, so that the order does not depend on the file system.
std::vector<fs::path> libraries_in(const Place& place, Diagnostics& diagnostics) {
  std::error_code error;
  fs::directory_iterator entries(place.dir, error);
  if (error) {
    if (!place.asked_by.empty()) {
      diagnostics.error("plugin-dir", error.message(), {.file = place.dir},
                        place.asked_by + " names folders that hold plugins (*.so)");
    }
    return {};
  }
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : entries) {
    if (entry.path().extension() == ".so") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Lets the plugin register and makes each of its passes once: a constructor that throws is found here, by name, and
/// not when a pipeline first uses it. Throws what the plugin throws.
void register_plugin(const LoomPlugin& plugin, const std::string& path, Registry& registry) {
  plugin.add_to(registry);
  for (const PassType& type : registry.passes()) {
    if (type.plugin == path && type.create() == nullptr) throw Error("pass " + type.name + " is made as nothing");
  }
}

/// Adds the reason why `path` was refused. What Registry throws keeps its own code.
void refuse(const std::string& path, const std::exception* exception, Diagnostics& diagnostics) {
  if (const auto* error = dynamic_cast<const Error*>(exception)) {
    for (Diagnostic diagnostic : error->diagnostics().all()) {
      if (diagnostic.code == "failed") diagnostic.code = "plugin-throws";
      if (diagnostic.where.file.empty()) diagnostic.where.file = path;
      diagnostics.add(std::move(diagnostic));
    }
    return;
  }
  diagnostics.error(
      "plugin-throws",
      "registering it threw " + (exception != nullptr ? std::string("an exception: ") + exception->what()
                                                      : std::string("something that is no std::exception")),
      {.file = path}, "nothing of this plugin is used");
}

bool load_one(const std::string& path, bool copy, Registry& registry, Diagnostics& diagnostics, LoadedPlugin& loaded) {
  const std::optional<Library> library = open_library(path, copy, diagnostics);
  if (!library) return false;
  bool ok = false;
  registry.set_current_plugin(path);
  try {
    register_plugin(*library->plugin, path, registry);
    ok = true;
  } catch (const std::exception& exception) {
    refuse(path, &exception, diagnostics);
  } catch (...) {
    refuse(path, nullptr, diagnostics);
  }
  registry.set_current_plugin({});
  if (!ok) {
    registry.remove_plugin(path);  // before dlclose: what it registered is code of the library
    return false;
  }
  loaded = {.name = library->plugin->name, .path = path};
  registry.keep(library->handle);
  return true;
}

}  // namespace

std::vector<LoadedPlugin> load_plugins(const SearchPath& search, Registry& registry, Diagnostics& diagnostics) {
  std::vector<LoadedPlugin> loaded;
  std::set<fs::path> seen;  // one file reached by two folders is one plugin
  for (const Place& place : places(search)) {
    for (const fs::path& file : libraries_in(place, diagnostics)) {
      std::error_code error;
      const fs::path real = fs::canonical(file, error);
      if (error) {
        diagnostics.error("plugin-load", error.message(), {.file = file.string()},
                          "a link that leads nowhere: remove it");
        continue;
      }
      if (!seen.insert(real).second) continue;
      LoadedPlugin plugin;
      if (load_one(file.string(), search.copies, registry, diagnostics, plugin)) loaded.push_back(std::move(plugin));
    }
  }
  return loaded;
}

std::vector<std::string> plugin_files(const SearchPath& search) {
  std::vector<std::string> files;
  Diagnostics ignored;
  for (const Place& place : places(search))
    for (const fs::path& file : libraries_in(place, ignored)) files.push_back(file.string());
  return files;
}

std::vector<std::string> shader_roots(const SearchPath& search) {
  std::vector<std::string> roots = paths_of_variable("LOOM_SHADER_PATH");
  const auto add = [&](const std::string& dir) {
    std::error_code error;
    if (fs::is_directory(dir, error) && std::find(roots.begin(), roots.end(), dir) == roots.end()) roots.push_back(dir);
  };
  for (const Place& place : places(search)) add(place.dir + "/shaders");
  if (search.installed) add(data_dir() + "/shaders");
  return roots;
}

std::string data_dir() { return loom::data_dir(); }

}  // namespace loom::plugins
