// Stage 4: in order, every pass is told what its wires bring and declares its ports.
#include <algorithm>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/compile/draft.h"

namespace loom::graph {
namespace {

/// A history wire brings something that may be declared later in the order, so reflection is repeated until what the
/// wires brought is what their producers declare. A chain of n such wires needs n rounds; more than this never settles.
constexpr int max_rounds = 8;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

bool same(const BundleInfo& a, const BundleInfo& b) {
  return a.type == b.type && a.attributes == b.attributes && a.absent == b.absent &&
         std::equal(a.members.begin(), a.members.end(), b.members.begin(), b.members.end(),
                    [](const MemberDecl& x, const MemberDecl& y) { return x.name == y.name && x.desc == y.desc; });
}

class Reflection {
 public:
  explicit Reflection(Draft& draft) : draft_(draft) {}

  void run() {
    for (int round = 0; round < max_rounds; ++round) {
      start_round();
      for (const int pass : draft_.order) reflect_pass(draft_.passes[at(pass)], pass);
      if (!unsettled()) return;
    }
    const HistoryWire& wire = history_[changed_];
    draft_.diagnostics->error("unsettled-history",
                              "what `" + wire.wire->entry->text + "` carries changes with every reflection, " +
                                  std::to_string(max_rounds) + " times by now",
                              wire.wire->entry->where,
                              "what a pass declares may not depend on its own last frame without end");
  }

 private:
  struct HistoryWire {
    Wire* wire;
    BundleInfo brought;
  };

  void start_round() {
    draft_.versions.clear();
    for (std::size_t i = 0; i < draft_.externals.size(); ++i) {
      External& external = draft_.externals[i];
      external.version = static_cast<int>(draft_.versions.size());
      draft_.versions.push_back({.external = static_cast<int>(i), .root = external.version, .info = external.info});
    }
    for (auto& pass : draft_.passes) {
      pass.doubtful = false;
      pass.reflected = false;
      pass.versions.clear();
    }
  }

  /// True where a history wire brought something else than what its producer turned out to declare. Stores the version
  /// of each of those wires.
  bool unsettled() {
    bool changed = false;
    for (std::size_t i = 0; i < history_.size(); ++i) {
      Wire& wire = *history_[i].wire;
      wire.version = version_of(wire);
      if (wire.version == none) continue;
      const BundleInfo& now = draft_.versions[at(wire.version)].info;
      if (same(now, history_[i].brought)) continue;
      history_[i].brought = now;
      changed = true;
      changed_ = i;
    }
    return changed;
  }

  /// The version at the other end, or none where there is no such port or it was not reflected (yet).
  [[nodiscard]] int version_of(const Wire& wire) const {
    if (wire.external != none) return draft_.externals[at(wire.external)].version;
    if (wire.from_pass == none) return none;
    const DraftPass& producer = draft_.passes[at(wire.from_pass)];
    const int output = producer.reflected ? producer.output(wire.entry->from.port) : none;
    return output == none ? none : producer.versions[at(output)];
  }

  Ports::Upstream upstream_of(DraftPass& pass) {
    Ports::Upstream upstream;
    for (auto& wire : pass.wires) {
      if (wire.history() && wire.resolved()) {
        upstream.emplace(wire.entry->input, last_brought(wire));
        continue;
      }
      wire.version = version_of(wire);
      const bool broken = wire.version == none;
      if (broken || (wire.from_pass != none && draft_.passes[at(wire.from_pass)].doubtful)) pass.doubtful = true;
      if (broken)
        upstream.emplace(wire.entry->input, BundleInfo{.absent = "its wire is broken"});
      else
        upstream.emplace(wire.entry->input, draft_.versions[at(wire.version)].info);
    }
    return upstream;
  }

  const BundleInfo& last_brought(Wire& wire) {
    const auto it =
        std::find_if(history_.begin(), history_.end(), [&](const HistoryWire& known) { return known.wire == &wire; });
    return it != history_.end() ? it->brought : history_.emplace_back(HistoryWire{&wire, {}}).brought;
  }

  void reflect_pass(DraftPass& pass, int index) {
    if (!pass.usable()) {
      for (auto& wire : pass.wires) wire.version = wire.history() ? none : version_of(wire);
      return;
    }
    pass.ports = Ports(draft_.options->frame_size, upstream_of(pass),
                       [&draft = draft_](std::string_view rule) { return draft.rule(rule); });
    const std::string failed = run_reflect(pass);
    if (!failed.empty()) {
      if (!pass.doubtful)
        draft_.diagnostics->error(
            "pass-failed",
            "`" + pass.name() + "`: " + pass.type->name + " threw while it declared its ports: " + failed,
            pass.entry->where);
      pass.pass.reset();
      pass.ports = Ports({1, 1}, {});
      return;
    }
    pass.reflected = true;
    for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i)
      pass.versions.push_back(declare_version(pass, index, static_cast<int>(i)));
  }

  std::string run_reflect(DraftPass& pass) const {
    try {
      pass.pass->reflect(pass.ports, *draft_.facts);
      return {};
    } catch (const std::exception& error) {
      return error.what();
    } catch (...) {
      return "something that is no std::exception";
    }
  }

  /// What this output carries from here on.
  int declare_version(const DraftPass& pass, int pass_index, int output_index) {
    const OutputDecl& output = pass.ports.outputs[at(output_index)];
    Version version{.pass = pass_index, .output = output_index};
    version.info.type = output.type;
    version.info.attributes = output.attributes;
    version.info.absent = output.absent;
    const auto& through = output.forwards ? output.forwards : output.in_place;
    if (through && !output.absent) {
      const Wire* wire = pass.wire(*through);
      const int source = wire == nullptr || wire->history() ? none : wire->version;
      if (source == none) {
        version.info.absent = wire == nullptr ? "input `" + *through + "` is not wired" : "its wire is broken";
      } else if (draft_.versions[at(source)].info.absent) {
        version.info.absent = draft_.versions[at(source)].info.absent;
      } else if (output.forwards) {
        return source;
      } else {
        version.base = source;
        version.root = draft_.versions[at(source)].root;
        version.info.members = draft_.versions[at(source)].info.members;
        version.info.attributes.insert(draft_.versions[at(source)].info.attributes.begin(),
                                       draft_.versions[at(source)].info.attributes.end());
      }
    } else if (!output.absent) {
      version.info.members = output.members;
    }
    const int index = static_cast<int>(draft_.versions.size());
    if (version.root == none) version.root = index;
    draft_.versions.push_back(std::move(version));
    return index;
  }

  Draft& draft_;
  std::vector<HistoryWire> history_;
  std::size_t changed_ = 0;
};

}  // namespace

void reflect(Draft& draft) { Reflection(draft).run(); }

}  // namespace loom::graph
