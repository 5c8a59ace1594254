#pragma once
// Stage 1: what a pipeline file says, with every value's place, before any name in it is looked up.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "loom/diagnostic.h"
#include "loom/json.h"

namespace loom::graph {

/// "pass.port", "pass.port.member", "pass.port@prev" or, with pass = "inputs", "inputs.name".
struct Endpoint {
  std::string pass, port, member;
  bool history = false;
  [[nodiscard]] bool external() const { return pass == "inputs"; }
};

/// Empty where `text` is not an endpoint.
std::optional<Endpoint> endpoint_from(std::string_view text);

struct WireEntry {
  std::string input, text;
  Endpoint from;
  SourceLocation key_where, where;
};

struct PassEntry {
  std::string name;
  SourceLocation where;  ///< of its name
  json::Node node;       ///< the whole object, for Pass::configure
  const json::Node* type = nullptr;
  std::vector<WireEntry> wires;
  std::vector<const json::Member*> params;
};

struct OutputEntry {
  std::string name, text;
  std::optional<Endpoint> from;  ///< empty: null, the pipeline makes none
  SourceLocation key_where, where;
};

struct InputEntry {
  std::string name, type, format;
  int width = 0, height = 0;  ///< 0: the frame's
  SourceLocation where, type_where, format_where;
};

struct Document {
  std::string name, summary, file;
  std::vector<InputEntry> inputs;
  std::vector<PassEntry> passes;
  std::vector<OutputEntry> outputs;
  SourceLocation outputs_where;
  std::vector<std::string> files;  ///< this file and what it extends
};

/// The object of a file with what it extends merged in; each value keeps the place it came from. A null node, with
/// diagnostics, where there is no such object.
struct Loaded {
  json::Node root;
  std::vector<std::string> files;
};
Loaded load_file(const std::string& path, Diagnostics& diagnostics);
Loaded load_text(const std::string& text, const std::string& file, Diagnostics& diagnostics);

/// Reads the merged object. Entries that are wrong are reported and left out.
Document read_document(Loaded loaded, const std::string& file, Diagnostics& diagnostics);

/// Keys that any pass may have; Pass::own_keys() adds to them.
inline constexpr std::string_view pass_keys[] = {"type", "in", "params", "summary"};

/// "did you mean `x`?", or the candidates where none is near and they are few.
std::string name_hint(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace loom::graph
