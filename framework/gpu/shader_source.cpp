#include "gpu/shader_source.h"

#include <epoxy/gl.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "loom/diagnostic.h"

namespace loom::gpu {
namespace {

namespace fs = std::filesystem;

constexpr int max_depth = 64;  // of nested includes: deeper is a cycle

constexpr std::array<std::pair<std::string_view, GLenum>, 6> stages{{{".vert", GL_VERTEX_SHADER},
                                                                     {".tesc", GL_TESS_CONTROL_SHADER},
                                                                     {".tese", GL_TESS_EVALUATION_SHADER},
                                                                     {".geom", GL_GEOMETRY_SHADER},
                                                                     {".frag", GL_FRAGMENT_SHADER},
                                                                     {".comp", GL_COMPUTE_SHADER}}};

[[noreturn]] void fail(std::string code, std::string message, SourceLocation where, std::string hint) {
  Diagnostics diagnostics;
  diagnostics.error(std::move(code), std::move(message), std::move(where), std::move(hint));
  throw Error(std::move(diagnostics));
}

unsigned int stage_of(const std::string& name) {
  const std::string suffix = fs::path(name).extension().string();
  const auto* it = std::find_if(stages.begin(), stages.end(), [&](const auto& stage) { return stage.first == suffix; });
  if (it == stages.end())
    fail("shader-stage", fmt::format("shader file '{}': the suffix '{}' names no stage", name, suffix), {.file = name},
         "use .vert, .tesc, .tese, .geom, .frag or .comp");
  return it->second;
}

std::optional<std::string> read_text(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

std::string list(std::span<const std::string> roots) {
  if (roots.empty()) return "no shader folder is known";
  std::string text = "searched:";
  for (const std::string& root : roots) text += " " + root;
  return text;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

// The word after `#` (spaces allowed between) and what follows it; empty where the line is no directive.
std::pair<std::string_view, std::string_view> directive(std::string_view line) {
  line = trimmed(line);
  if (line.empty() || line.front() != '#') return {};
  line = trimmed(line.substr(1));
  const std::size_t end = line.find_first_of(" \t\"<");
  return {line.substr(0, end), end == std::string_view::npos ? std::string_view{} : trimmed(line.substr(end))};
}

class Expander {
 public:
  Expander(ShaderSource& source, std::span<const std::string> roots) : source_(source), roots_(roots) {}

  void main_file(const std::string& name) {
    const auto found = find(name, {});
    if (!found) fail("shader-file", fmt::format("shader file '{}' not found", name), {.file = name}, list(roots_));
    expand(found->first, found->second, 0);
  }

 private:
  using Found = std::pair<std::string, std::string>;  // path, text

  std::optional<Found> find(const std::string& name, const fs::path& beside) const {
    if (fs::path(name).is_absolute()) {
      if (auto text = read_text(name)) return Found{name, std::move(*text)};
      return std::nullopt;
    }
    if (!beside.empty())
      if (auto text = read_text(beside / name)) return Found{(beside / name).lexically_normal().string(), *text};
    for (const std::string& root : roots_) {
      const fs::path path = (fs::path(root) / name).lexically_normal();
      if (auto text = read_text(path)) return Found{path.string(), std::move(*text)};
    }
    return std::nullopt;
  }

  std::size_t index_of(const std::string& path) {
    const auto it = std::find(source_.files.begin(), source_.files.end(), path);
    if (it != source_.files.end()) return static_cast<std::size_t>(it - source_.files.begin());
    source_.files.push_back(path);
    return source_.files.size() - 1;
  }

  void expand(const std::string& path, const std::string& text, int depth) {
    const std::size_t index = index_of(path);
    std::string& out = source_.text;
    const bool once = text.find("#pragma once") != std::string::npos;
    // Named by content order, not by path: the same sources in another folder hash to the same program.
    if (once) out += fmt::format("#ifndef LOOM_ONCE_{0}\n#define LOOM_ONCE_{0}\n", index);
    out += fmt::format("#line 1 {}\n", index);
    bool comment = false;
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      const std::string_view line = std::string_view(text).substr(begin, end - begin);
      begin = end + 1;
      ++number;
      const auto [word, rest] = comment ? std::pair<std::string_view, std::string_view>{} : directive(line);
      comment = ends_in_comment(line, comment);
      if (word == "include") {
        include(path, number, rest, depth);
        out += fmt::format("#line {} {}\n", number + 1, index);
      } else if (word == "version" || (word == "pragma" && rest == "once")) {
        out += '\n';  // the version is given by load_shader
      } else {
        out += line;
        out += '\n';
      }
    }
    if (once) out += "#endif\n";
  }

  void include(const std::string& path, int line, std::string_view target, int depth) {
    if (!target.empty() && target.front() == '<') return;
    const SourceLocation where{.file = path, .line = line, .column = 1};
    const std::size_t close = target.size() > 1 ? target.find('"', 1) : std::string_view::npos;
    if (target.empty() || target.front() != '"' || close == std::string_view::npos)
      fail("shader-include", "#include wants a file name in double quotes", where, "#include \"lib/math.glsl\"");
    const std::string name(target.substr(1, close - 1));
    if (depth >= max_depth)
      fail("shader-include", fmt::format("includes nest deeper than {}: '{}' includes itself", max_depth, name), where,
           "a file that is included more than once needs a guard, and none may include itself");
    const auto found = find(name, fs::path(path).parent_path());
    if (!found) fail("shader-include", fmt::format("included file '{}' not found", name), where, list(roots_));
    expand(found->first, found->second, depth + 1);
  }

  // Whether a block comment is open after the line.
  static bool ends_in_comment(std::string_view line, bool open) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const std::string_view two = line.substr(i, 2);
      if (open && two == "*/") {
        open = false;
        ++i;
      } else if (!open && two == "/*") {
        open = true;
        ++i;
      } else if (!open && two == "//") {
        break;
      }
    }
    return open;
  }

  ShaderSource& source_;
  std::span<const std::string> roots_;
};

}  // namespace

ShaderSource load_shader(const std::string& name, std::span<const std::string> roots, std::span<const Define> defines) {
  ShaderSource source{.stage = stage_of(name), .name = name};
  source.text = "#version 450 core\n";
  for (const auto& [key, value] : defines) source.text += fmt::format("#define {} {}\n", key, value);
  Expander(source, roots).main_file(name);
  return source;
}

std::string name_files(std::string_view log, const std::vector<std::string>& files) {
  static const std::regex place(R"(^((?:ERROR|WARNING): )?(\d+)(?::(\d+)\((\d+)\)|\((\d+)\)|:(\d+))\s*:?\s*)");
  std::string result;
  for (std::size_t begin = 0; begin < log.size();) {
    const std::size_t end = std::min(log.find('\n', begin), log.size());
    const std::string line(log.substr(begin, end - begin));
    begin = end + 1;
    std::smatch match;
    const bool placed = std::regex_search(line, match, place) && match[2].length() < 6 &&
                        static_cast<std::size_t>(std::stoi(match[2])) < files.size();
    if (!placed) {
      result += line;
    } else {
      const std::string number = match[3].matched ? match[3].str() : match[5].matched ? match[5].str() : match[6].str();
      result += files[static_cast<std::size_t>(std::stoi(match[2]))] + ":" + number;
      if (match[4].matched) result += ":" + match[4].str();
      result += ": " + match[1].str() + match.suffix().str();
    }
    if (begin <= log.size()) result += '\n';
  }
  while (!result.empty() && (result.back() == '\n' || result.back() == '\0')) result.pop_back();
  return result;
}

}  // namespace loom::gpu
