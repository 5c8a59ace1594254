#pragma once
// The graph between parsing and plan: what stages 2–5 find out about it, one stage after the other.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graph/compile/compile.h"
#include "graph/compile/document.h"
#include "loom/pass.h"
#include "loom/ports.h"

namespace loom::graph {

struct Wire {
  const WireEntry* entry = nullptr;
  int from_pass = none;   ///< index into Draft::passes
  int external = none;    ///< index into Draft::externals; both none: the endpoint names nothing
  int version = none;     ///< what it carries, index into Draft::versions; none: nothing known
  bool in_cycle = false;  ///< reported, and imposes no order
  [[nodiscard]] bool history() const { return entry->from.history; }
  [[nodiscard]] bool resolved() const { return from_pass != none || external != none; }
};

struct DraftPass {
  const PassEntry* entry = nullptr;
  const PassType* type = nullptr;
  std::unique_ptr<Pass> pass;  ///< null where the type is unknown or could not be made
  Params params;
  Ports ports{{1, 1}, {}};
  std::vector<Wire> wires;
  std::vector<int> versions;  ///< of each output
  bool reflected = false;
  bool doubtful = false;  ///< something upstream is broken: what it says of its wiring is not worth reporting
  [[nodiscard]] const std::string& name() const { return entry->name; }
  [[nodiscard]] bool usable() const { return pass != nullptr; }
  [[nodiscard]] const Wire* wire(std::string_view input) const;
  [[nodiscard]] const InputDecl* input(std::string_view port) const;
  [[nodiscard]] int output(std::string_view port) const;  ///< index, or none
};

struct External {
  const InputEntry* entry = nullptr;
  BundleInfo info;
  int version = none;
};

/// One value of a bundle: what a pass produced, or what an in-place writer made of it. Forwarding outputs share the
/// version of their input.
struct Version {
  int pass = none;      ///< who wrote it; none: external
  int output = none;    ///< which of its outputs
  int external = none;  ///< or which external input
  int base = none;      ///< in place: the version whose storage this one took over
  int root = none;      ///< the version that owns the storage (itself, where not in place)
  BundleInfo info;
};

/// A checked output: of the file, or `pass.port[.member]` asked for.
struct Target {
  std::string name, endpoint, member, quantity;
  int version = none;
  std::optional<std::string> absent;
  SourceLocation where;
};

struct Draft {
  const Document* document = nullptr;
  const Registry* registry = nullptr;
  const SceneFacts* facts = nullptr;
  const CompileOptions* options = nullptr;
  Diagnostics* diagnostics = nullptr;

  std::vector<DraftPass> passes;
  std::unordered_map<std::string_view, int> pass_index;
  std::vector<External> externals;
  std::vector<Version> versions;
  std::vector<int> order;       ///< every pass, producers first
  std::vector<Target> targets;  ///< what is asked for

  [[nodiscard]] bool rule(std::string_view name) const;
  [[nodiscard]] const DraftPass* pass(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> pass_names() const;
  /// "rsm.lights", "inputs.env"
  [[nodiscard]] std::string version_name(int version) const;
  [[nodiscard]] bool takes_in_place(const DraftPass& pass, std::string_view input) const;
};

/// "LightLayers (flux, normal, depth)"
std::string carries(const BundleInfo& info);

void resolve(Draft& draft);               // 2: types, parameters, endpoints
void order_for_reflection(Draft& draft);  // 3: producers before consumers; reports cycles
void reflect(Draft& draft);               // 4: every pass declares its ports
void validate(Draft& draft);              // 5: ports, bundles, members, outputs
void order_in_place(Draft& draft);        // 3 again: in-place writers after the readers of the old value
/// 6. Only where nothing above reported an error; may report one itself.
CompiledGraph plan(Draft& draft);

}  // namespace loom::graph
