// Stage 6a: cull backwards from what is asked for.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "graph/compile/plan.h"

namespace loom::graph {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

bool is_absent(const Draft& draft, int version) { return draft.versions[at(version)].info.absent.has_value(); }

/// A pass whose outputs are all absent or forwarded has nothing to do.
bool can_run(const Draft& draft, const DraftPass& pass) {
  if (pass.ports.has_side_effect || pass.ports.outputs.empty()) return true;
  for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i)
    if (!pass.ports.outputs[i].forwards && !is_absent(draft, pass.versions[i])) return true;
  return false;
}

class Marking {
 public:
  explicit Marking(const Draft& draft) : draft_(draft) {
    alive_.runs.assign(draft.passes.size(), 0);
    alive_.overwritten.assign(draft.versions.size(), 0);
    alive_.members.resize(draft.versions.size());
    alive_.history.resize(draft.versions.size());
    for (std::size_t v = 0; v < draft.versions.size(); ++v) {
      if (draft.versions[v].root != static_cast<int>(v)) continue;
      alive_.members[v].assign(draft.versions[v].info.members.size(), 0);
      alive_.history[v].assign(draft.versions[v].info.members.size(), 0);
    }
  }

  Liveness run() {
    const bool everything = !draft_.rule("unread");
    for (std::size_t p = 0; p < draft_.passes.size(); ++p)
      if (everything || draft_.passes[p].ports.has_side_effect) mark_pass(static_cast<int>(p));
    if (everything)
      for (auto& members : alive_.members) std::fill(members.begin(), members.end(), 1);
    for (const auto& target : draft_.targets)
      if (target.version != none && !target.absent) {
        mark_writers(target.version);
        mark_member(target.version, target.member, false);
      }
    while (!queue_.empty()) {
      const int pass = queue_.back();
      queue_.pop_back();
      for (const auto& wire : draft_.passes[at(pass)].wires) follow(draft_.passes[at(pass)], wire);
    }
    mark_needed_for_others();
    for (const auto& version : draft_.versions)
      if (version.base != none && alive_.runs[at(version.pass)] != 0) alive_.overwritten[at(version.root)] = 1;
    return std::move(alive_);
  }

 private:
  void mark_pass(int pass) {
    if (alive_.runs[at(pass)] != 0 || !can_run(draft_, draft_.passes[at(pass)])) return;
    alive_.runs[at(pass)] = 1;
    queue_.push_back(pass);
    for (const int version : draft_.passes[at(pass)].versions) mark_needed(version);
  }

  /// Whoever made this value, and whoever made the one it was made of in place.
  void mark_writers(int version) {
    for (int v = version; v != none; v = draft_.versions[at(v)].base)
      if (draft_.versions[at(v)].pass != none) mark_pass(draft_.versions[at(v)].pass);
  }

  void mark_member(int version, std::string_view name, bool history) {
    const int root = draft_.versions[at(version)].root;
    const auto& members = draft_.versions[at(root)].info.members;
    for (std::size_t m = 0; m < members.size(); ++m) {
      if (members[m].name != name) continue;
      alive_.members[at(root)][m] = 1;
      if (history) alive_.history[at(root)][m] = 1;
    }
  }

  /// What a pass reads back of its own outputs.
  void mark_needed(int version) {
    const Version& made = draft_.versions[at(version)];
    if (made.root != version) return;
    for (std::size_t m = 0; m < made.info.members.size(); ++m)
      if (made.info.members[m].needed) alive_.members[at(version)][m] = 1;
  }

  /// What a pass reads back to make members that somebody reads.
  void mark_needed_for_others() {
    for (std::size_t v = 0; v < draft_.versions.size(); ++v) {
      const auto& members = draft_.versions[v].info.members;
      auto& made = alive_.members[v];
      const auto is_made = [&](std::string_view name) {
        for (std::size_t m = 0; m < made.size(); ++m)
          if (members[m].name == name && made[m] != 0) return true;
        return false;
      };
      for (bool again = true; again;) {
        again = false;
        for (std::size_t m = 0; m < made.size(); ++m) {
          const auto& others = members[m].needed_for;
          if (made[m] != 0 || std::none_of(others.begin(), others.end(), is_made)) continue;
          made[m] = 1;
          again = true;
        }
      }
    }
  }

  void follow(const DraftPass& pass, const Wire& wire) {
    const InputDecl* input = pass.input(wire.entry->input);
    if (input == nullptr || wire.version == none || is_absent(draft_, wire.version)) return;
    mark_writers(wire.version);  // even if no member is read: the bundle's struct comes from there
    for (const auto& read : input->reads) mark_member(wire.version, read.member, wire.history());
    if (input->reads_all)
      for (const auto& member : draft_.versions[at(wire.version)].info.members)
        mark_member(wire.version, member.name, wire.history());
  }

  const Draft& draft_;
  Liveness alive_;
  std::vector<int> queue_;
};

/// Why outputs and members are not made: who would have read them.
class Readers {
 public:
  Readers(const Draft& draft, const Liveness& alive) : draft_(draft), alive_(alive), wires_(draft.passes.size()) {
    for (std::size_t p = 0; p < draft.passes.size(); ++p)
      for (const auto& wire : draft.passes[p].wires)
        if (wire.from_pass != none && wire.from_pass != static_cast<int>(p))
          wires_[at(wire.from_pass)].push_back({static_cast<int>(p), &wire});
  }

  /// `port` and `member` empty: any.
  [[nodiscard]] std::string why_unread(int producer, std::string_view port = {}, std::string_view member = {}) const {
    std::string names;
    std::size_t idle = 0;
    int last = none;
    for (const auto& [reader, wire] : wires_[at(producer)]) {
      if (alive_.runs[at(reader)] != 0 || reader == last || !reads(draft_.passes[at(reader)], *wire, port, member))
        continue;
      last = reader;
      ++idle;
      names += (names.empty() ? "`" : ", `") + draft_.passes[at(reader)].name() + '`';
    }
    if (names.empty()) return "nothing reads it";
    return "read by " + names + (idle == 1 ? " alone, which does not run" : " alone, which do not run");
  }

 private:
  static bool reads(const DraftPass& pass, const Wire& wire, std::string_view port, std::string_view member) {
    if (!port.empty() && wire.entry->from.port != port) return false;
    if (member.empty()) return true;
    const InputDecl* input = pass.input(wire.entry->input);
    return input != nullptr &&
           (input->reads_all || std::any_of(input->reads.begin(), input->reads.end(),
                                            [&](const auto& read) { return read.member == member; }));
  }

  const Draft& draft_;
  const Liveness& alive_;
  std::vector<std::vector<std::pair<int, const Wire*>>> wires_;  // by producer, in file order
};

std::string why_idle(const Draft& draft, const DraftPass& pass) {
  std::string why;
  for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i) {
    const OutputDecl& output = pass.ports.outputs[i];
    if (!why.empty()) why += "; ";
    why += '`' + output.name + "` ";
    if (is_absent(draft, pass.versions[i]))
      why += "carries nothing: " + *draft.versions[at(pass.versions[i])].info.absent;
    else
      why += "is `" + *output.forwards + "` unchanged";
  }
  return why;
}

void leave_out(CompiledGraph& graph, std::string what, std::string why, bool by_rule) {
  if (by_rule) graph.decisions.push_back({"unread", '`' + what + "` left out", why, {}});
  graph.pruned.push_back({std::move(what), std::move(why)});
}

void explain_output(const Draft& draft, const Liveness& alive, const Readers& readers, int index,
                    std::size_t output_index, CompiledGraph& graph) {
  const DraftPass& pass = draft.passes[at(index)];
  const OutputDecl& output = pass.ports.outputs[output_index];
  const int version = pass.versions[output_index];
  const std::string path = pass.name() + '.' + output.name;
  if (is_absent(draft, version)) {
    leave_out(graph, path, *draft.versions[at(version)].info.absent, false);
    return;
  }
  if (output.forwards || output.in_place) return;
  const auto& members = draft.versions[at(version)].info.members;
  const auto& made = alive.members[at(version)];
  if (std::find(made.begin(), made.end(), 0) == made.end()) return;
  if (std::find(made.begin(), made.end(), 1) == made.end()) {
    leave_out(graph, path, readers.why_unread(index, output.name), true);
    return;
  }
  for (std::size_t m = 0; m < members.size(); ++m)
    if (made[m] == 0)
      leave_out(graph, path + '.' + members[m].name, readers.why_unread(index, output.name, members[m].name), true);
}

}  // namespace

Liveness find_alive(const Draft& draft) { return Marking(draft).run(); }

void explain_pruned(const Draft& draft, const Liveness& alive, CompiledGraph& graph) {
  const Readers readers(draft, alive);
  for (std::size_t p = 0; p < draft.passes.size(); ++p) {
    const DraftPass& pass = draft.passes[p];
    if (!can_run(draft, pass)) {
      leave_out(graph, pass.name(), why_idle(draft, pass), false);
    } else if (alive.runs[p] == 0) {
      leave_out(graph, pass.name(), readers.why_unread(static_cast<int>(p)), true);
    } else {
      for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i)
        explain_output(draft, alive, readers, static_cast<int>(p), i, graph);
    }
  }
}

}  // namespace loom::graph
