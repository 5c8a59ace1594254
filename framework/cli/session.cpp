#include "cli/session.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace loom::cli {
namespace {

namespace fs = std::filesystem;

/// Larger frames than any driver takes are a typing error.
constexpr int max_size = 32768;

/// Stems of the files in a data folder that end in one of `extensions`, sorted.
std::vector<std::string> stems(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (std::find(extensions.begin(), extensions.end(), entry.path().extension()) != extensions.end()) {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string near = nearest_name(fs::path(name).stem().string(), candidates);
  return (near.empty() ? "" : "did you mean " + near + "? ") + "shipped: " + joined(candidates);
}

}  // namespace

BadInput bad_input(std::string code, std::string message, std::string hint, std::string file) {
  Diagnostic diagnostic;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  diagnostic.where.file = std::move(file);
  return BadInput(std::move(diagnostic));
}

BadInput bad_usage(std::string message, std::string hint) {
  return bad_input("usage", std::move(message), std::move(hint));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void add_plugin_option(CLI::App& command, Session& session) {
  command.add_option("--plugins", session.plugin_dirs, "Folder with further passes (*.so); may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

void add_json_option(CLI::App& command, Session& session) {
  command.add_flag("--json", session.json, "Write JSON to stdout, diagnostics too");
}

Registry load_registry(const Session& session, Diagnostics* refused) {
  Registry registry;
  Diagnostics diagnostics;
  plugins::load_plugins(session.search(), registry, diagnostics);
  Diagnostics bad_folders;
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    if (diagnostic.code == "plugin-dir") bad_folders.add(diagnostic);
  }
  if (bad_folders.has_errors()) throw BadInput(bad_folders);
  report(diagnostics);
  if (refused != nullptr) refused->append(diagnostics);
  return registry;
}

std::vector<std::string> shipped_pipelines() { return stems(fs::path(plugins::data_dir()) / "pipelines", {".json"}); }

std::string find_pipeline(const std::string& name) {
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return name;
  if (name.find('/') == std::string::npos && !name.empty()) {
    const fs::path shipped = fs::path(plugins::data_dir()) / "pipelines" / name;
    for (const fs::path& path : {shipped, fs::path(shipped.string() + ".json")}) {
      if (fs::is_regular_file(path, ignored)) return path.string();
    }
  }
  throw bad_input("no-such-pipeline", "no pipeline " + name + ": neither a file nor the name of a shipped one",
                  suggestion(name, shipped_pipelines()), name);
}

std::string find_scene(const std::string& name) {
  std::error_code ignored;
  if (name.empty() || fs::is_regular_file(name, ignored)) return name;
  const fs::path configs = fs::path(plugins::data_dir()) / "configs";
  if (name.find('/') == std::string::npos) {
    for (const char* place : {"scenes/", "runs/"}) {
      for (const char* extension : {"", ".gltf", ".glb", ".json"}) {
        const fs::path path = configs / (place + name + extension);
        if (fs::is_regular_file(path, ignored)) return path.string();
      }
    }
  }
  std::vector<std::string> candidates = stems(configs / "scenes", {".gltf", ".glb"});
  for (std::string& run : stems(configs / "runs", {".json"})) candidates.push_back(std::move(run));
  throw bad_input("no-such-scene", "no scene " + name + ": neither a file nor the name of a shipped one",
                  suggestion(name, candidates), name);
}

glm::ivec2 parse_size(const std::string& text) {
  glm::ivec2 size{0};
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.x);
  const bool separated = width.ec == std::errc{} && width.ptr != end && (*width.ptr == 'x' || *width.ptr == 'X');
  const auto height = separated ? std::from_chars(width.ptr + 1, end, size.y) : width;
  if (!separated || height.ec != std::errc{} || height.ptr != end || size.x < 1 || size.y < 1 || size.x > max_size ||
      size.y > max_size) {
    throw bad_usage("--size " + text + ": expected WIDTHxHEIGHT, each from 1 to " + std::to_string(max_size),
                    "for example --size 640x360");
  }
  return size;
}

std::string bytes_text(std::size_t bytes) {
  static constexpr std::array units = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1024 && unit + 1 < units.size()) {
    value /= 1024;
    ++unit;
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
  return text.data();
}

void report(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    std::fprintf(stderr, "%s\n", to_string(diagnostic).c_str());
  }
}

void note(const std::string& text) { std::fprintf(stderr, "note: %s\n", text.c_str()); }

}  // namespace loom::cli
