#include "graph/compile/compile.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "graph/compile/document.h"
#include "graph/compile/draft.h"
#include "graph/compile/plan.h"

namespace loom::graph {
namespace {

/// In the order in which the mistakes stand in the files, the pipeline's own first.
Diagnostics in_file_order(const Diagnostics& diagnostics, const std::vector<std::string>& files) {
  std::vector<Diagnostic> sorted = diagnostics.all();
  const auto place = [&](const Diagnostic& diagnostic) {
    const auto file = std::find(files.begin(), files.end(), diagnostic.where.file) - files.begin();
    return std::tuple(file, diagnostic.where.line, diagnostic.where.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
  Diagnostics result;
  for (auto& diagnostic : sorted) result.add(std::move(diagnostic));
  return result;
}

CompileResult compile(Loaded loaded, const std::string& file, const Registry& registry, const SceneFacts& facts,
                      const CompileOptions& options, Diagnostics diagnostics) {
  CompileResult result;
  const std::vector<std::string> files = loaded.files;
  if (loaded.root.is(json::Kind::object)) {
    const Document document = read_document(std::move(loaded), file, diagnostics);
    Draft draft;
    draft.document = &document;
    draft.registry = &registry;
    draft.facts = &facts;
    draft.options = &options;
    draft.diagnostics = &diagnostics;
    resolve(draft);
    order_for_reflection(draft);
    reflect(draft);
    validate(draft);
    order_in_place(draft);
    if (!diagnostics.has_errors()) {
      CompiledGraph graph = plan(draft);
      if (!diagnostics.has_errors()) result.graph = std::move(graph);
    }
  }
  result.diagnostics = diagnostics.all().empty() ? std::move(diagnostics) : in_file_order(diagnostics, files);
  return result;
}

std::vector<Edge> edges_of(const Draft& draft) {
  std::vector<Edge> edges;
  for (const auto& pass : draft.passes)
    for (const auto& wire : pass.wires)
      edges.push_back({.from_pass = wire.entry->from.pass,
                       .from_port = wire.entry->from.port,
                       .to_pass = pass.name(),
                       .to_port = wire.entry->input,
                       .type = draft.versions[static_cast<std::size_t>(wire.version)].info.type,
                       .history = wire.history()});
  return edges;
}

/// One row for all wires that carry one channel: every pass takes part in it.
void explain_channels(const Draft& draft, CompiledGraph& graph) {
  std::size_t wires = 0;
  for (const auto& version : draft.versions) {
    const auto channels = version.info.attributes.find("channels");
    if (channels == version.info.attributes.end() || version.info.absent) continue;
    const int* count = std::get_if<int>(&channels->second);
    if (count != nullptr && *count == 1) ++wires;
  }
  if (wires == 0) return;
  graph.decisions.push_back(
      {"achromatic",
       "one channel instead of three on " + std::to_string(wires) + " outputs",
       fmt::format("no light, albedo, emission or sky of a chroma over {:.2g}", draft.facts->max_chroma),
       {}});
}

}  // namespace

CompiledGraph plan(Draft& draft) {
  CompiledGraph graph;
  graph.name = draft.document->name;
  graph.summary = draft.document->summary;
  graph.file = draft.document->file;
  graph.files = draft.document->files;
  graph.edges = edges_of(draft);
  explain_channels(draft, graph);
  for (const auto& pass : draft.passes)
    for (const auto& decision : pass.ports.decisions) {
      graph.decisions.push_back(decision);
      graph.decisions.back().pass = pass.name();
    }
  const Liveness alive = find_alive(draft);
  explain_pruned(draft, alive, graph);
  graph.passes.resize(draft.passes.size());
  make_resources(draft, alive, graph);
  for (std::size_t i = 0; i < draft.passes.size(); ++i) {
    DraftPass& from = draft.passes[i];
    CompiledPass& to = graph.passes[i];
    to.name = from.name();
    to.type = from.type->name;
    to.pass = std::move(from.pass);
    to.params = std::move(from.params);
    to.ports = std::move(from.ports);
    to.runs = alive.runs[i] != 0;
    to.where = from.entry->where;
  }
  assign_slots(graph, draft.options->alias);
  place_barriers(graph);
  return graph;
}

const CompiledPass* CompiledGraph::pass(std::string_view wanted) const {
  const auto it = std::find_if(passes.begin(), passes.end(),
                               [&](const CompiledPass& candidate) { return candidate.name == wanted; });
  return it == passes.end() ? nullptr : &*it;
}

CompileResult compile_file(const std::string& path, const Registry& registry, const SceneFacts& facts,
                           const CompileOptions& options) {
  Diagnostics diagnostics;
  Loaded loaded = load_file(path, diagnostics);
  return compile(std::move(loaded), path, registry, facts, options, std::move(diagnostics));
}

CompileResult compile_text(const std::string& text, const std::string& file, const Registry& registry,
                           const SceneFacts& facts, const CompileOptions& options) {
  Diagnostics diagnostics;
  Loaded loaded = load_text(text, file, diagnostics);
  return compile(std::move(loaded), file, registry, facts, options, std::move(diagnostics));
}

}  // namespace loom::graph
