#pragma once
// What the subcommands share: the options that every one of them takes, and the way from names to files and registries.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <glm/vec2.hpp>

#include "loom/diagnostic.h"
#include "loom/registry.h"
#include "plugins/loader.h"

namespace loom::cli {

struct Session {
  std::vector<std::string> plugin_dirs;  ///< --plugins
  bool json = false;                     ///< --json: machine-readable stdout, also when it fails
  int exit_code = 0;

  [[nodiscard]] plugins::SearchPath search() const { return {.dirs = plugin_dirs}; }
};

/// `--plugins DIR`.
void add_plugin_option(CLI::App& command, Session& session);
/// `--json`.
void add_json_option(CLI::App& command, Session& session);

/// Every pass type there is. Refused plugins are reported on stderr (and, where wanted, in `refused`); a folder given
/// by
/// --plugins that cannot be read is BadInput.
Registry load_registry(const Session& session, Diagnostics* refused = nullptr);

/// A path, or the name of a shipped pipeline with or without `.json`. Throws BadInput with the nearest name.
std::string find_pipeline(const std::string& name);
/// Names of the shipped pipelines, sorted.
std::vector<std::string> shipped_pipelines();
/// A path, the name of a shipped scene or run file, or empty for the built-in scene.
std::string find_scene(const std::string& name);

BadInput bad_input(std::string code, std::string message, std::string hint = {}, std::string file = {});
/// What the user must mend on the command line (code `usage`).
BadInput bad_usage(std::string message, std::string hint = {});
/// "a, b, c".
std::string joined(const std::vector<std::string>& words);
/// `WxH`. Throws BadInput.
glm::ivec2 parse_size(const std::string& text);
/// "12.3 MiB".
std::string bytes_text(std::size_t bytes);
/// "loom 0.1.0 (1a2b3c4)": version and commit, a `+` behind it where the sources were changed.
std::string program_version();
/// One line each to stderr.
void report(const Diagnostics& diagnostics);
void note(const std::string& text);

}  // namespace loom::cli
