// Stage 3: producers before consumers, as in the file where that leaves a choice; in-place writers after the readers of
// the old value.
#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "graph/compile/draft.h"

namespace loom::graph {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// `from` runs before `to`; `why` is the wire's text, or what an in-place writer changes.
struct Arc {
  int from, to;
  const Wire* wire = nullptr;
  int changes = none;  ///< in-place order: the version that `to` overwrites
};

struct Arcs {
  std::vector<Arc> all;
  std::vector<std::vector<int>> out;  ///< by pass, indices into all
  explicit Arcs(std::size_t passes) : out(passes) {}
  void add(Arc arc) {
    out[at(arc.from)].push_back(static_cast<int>(all.size()));
    all.push_back(arc);
  }
};

/// Kahn's algorithm with the least file position first; passes on or behind a cycle are missing from the result.
std::vector<int> sorted(const Arcs& arcs) {
  const std::size_t count = arcs.out.size();
  std::vector<int> waits(count, 0);
  for (const auto& arc : arcs.all) ++waits[at(arc.to)];
  std::priority_queue<int, std::vector<int>, std::greater<>> free;
  for (std::size_t i = 0; i < count; ++i)
    if (waits[i] == 0) free.push(static_cast<int>(i));
  std::vector<int> order;
  order.reserve(count);
  while (!free.empty()) {
    const int pass = free.top();
    free.pop();
    order.push_back(pass);
    for (const int arc : arcs.out[at(pass)])
      if (--waits[at(arcs.all[at(arc)].to)] == 0) free.push(arcs.all[at(arc)].to);
  }
  return order;
}

/// The shortest way from a pass back to itself, as arcs, or empty.
std::vector<int> cycle_through(const Arcs& arcs, int start, const std::vector<bool>& left) {
  std::vector<int> reached_by(arcs.out.size(), none);
  std::deque<int> queue = {start};
  while (!queue.empty()) {
    const int pass = queue.front();
    queue.pop_front();
    for (const int index : arcs.out[at(pass)]) {
      const Arc& arc = arcs.all[at(index)];
      if (!left[at(arc.to)] || reached_by[at(arc.to)] != none) continue;
      reached_by[at(arc.to)] = index;
      if (arc.to == start) {
        std::vector<int> path;
        int walk = start;
        do {
          path.push_back(reached_by[at(walk)]);
          walk = arcs.all[at(path.back())].from;
        } while (walk != start);
        std::reverse(path.begin(), path.end());
        return path;
      }
      queue.push_back(arc.to);
    }
  }
  return {};
}

std::string described(const Draft& draft, const Arc& arc) {
  const std::string& to = draft.passes[at(arc.to)].name();
  if (arc.wire != nullptr) return '`' + arc.wire->entry->text + "` → `" + to + '.' + arc.wire->entry->input + '`';
  return '`' + draft.passes[at(arc.from)].name() + "` reads `" + draft.version_name(arc.changes) + "` before `" + to +
         "` overwrites it";
}

void report_cycle(Draft& draft, const Arcs& arcs, const std::vector<int>& path) {
  std::string text;
  const Arc* last_wire = nullptr;
  const Arc* overwrite = nullptr;
  for (const int index : path) {
    const Arc& arc = arcs.all[at(index)];
    text += (text.empty() ? "" : ", ") + described(draft, arc);
    (arc.wire != nullptr ? last_wire : overwrite) = &arc;
  }
  const Arc& closing = last_wire != nullptr ? *last_wire : arcs.all[at(path.back())];
  const auto& consumer = draft.passes[at(closing.to)];
  const SourceLocation where = closing.wire != nullptr ? closing.wire->entry->where : consumer.entry->where;
  if (overwrite != nullptr) {
    const std::string& writer = draft.passes[at(overwrite->to)].name();
    draft.diagnostics->error("in-place-cycle", "no order satisfies this: " + text, where,
                             "wire `" + draft.passes[at(overwrite->from)].name() + "` to what `" + writer +
                                 "` makes of it, or read before it is overwritten");
    return;
  }
  draft.diagnostics->error("cycle", "these passes wait for each other: " + text, where,
                           "use @prev where the last frame's value will do: \"" + closing.wire->entry->input +
                               "\": \"" + closing.wire->entry->text + "@prev\"");
}

/// Reports one shortest cycle of every knot of passes, and cuts its wires until none is left.
std::vector<int> sorted_or_cut(Draft& draft, const std::function<Arcs()>& arcs_now,
                               const std::function<void(const Arc&)>& cut) {
  for (;;) {
    const Arcs arcs = arcs_now();
    std::vector<int> order = sorted(arcs);
    if (order.size() == draft.passes.size()) return order;
    std::vector<bool> left(draft.passes.size(), true);
    for (const int pass : order) left[at(pass)] = false;
    std::vector<int> path;
    for (std::size_t i = 0; i < left.size() && path.empty(); ++i)
      if (left[i]) path = cycle_through(arcs, static_cast<int>(i), left);
    report_cycle(draft, arcs, path);
    for (const int index : path) cut(arcs.all[at(index)]);
  }
}

Arcs wire_arcs(const Draft& draft) {
  Arcs arcs(draft.passes.size());
  for (std::size_t i = 0; i < draft.passes.size(); ++i)
    for (const auto& wire : draft.passes[i].wires)
      if (wire.from_pass != none && !wire.history() && !wire.in_cycle)
        arcs.add({wire.from_pass, static_cast<int>(i), &wire});
  return arcs;
}

/// Who overwrites each version; a second writer of one version is reported.
std::vector<int> overwriters(Draft& draft) {
  std::vector<int> by(draft.versions.size(), none);
  for (std::size_t v = 0; v < draft.versions.size(); ++v) {
    const Version& version = draft.versions[v];
    if (version.base == none) continue;
    int& writer = by[at(version.base)];
    if (writer == none) {
      writer = version.pass;
      continue;
    }
    if (writer == version.pass) continue;
    const auto& first = draft.passes[at(writer)];
    const auto& second = draft.passes[at(version.pass)];
    draft.diagnostics->error("in-place-conflict",
                             "`" + first.name() + "` and `" + second.name() + "` both overwrite `" +
                                 draft.version_name(version.base) + "` in place",
                             second.entry->where, "wire the one that comes second to the output of the first");
  }
  return by;
}

}  // namespace

void order_for_reflection(Draft& draft) {
  draft.order = sorted_or_cut(
      draft, [&] { return wire_arcs(draft); },
      [&](const Arc& arc) {
        for (auto& wire : draft.passes[at(arc.to)].wires)
          if (&wire == arc.wire) wire.in_cycle = true;
      });
}

void order_in_place(Draft& draft) {
  const std::vector<int> overwriter = overwriters(draft);
  if (std::all_of(overwriter.begin(), overwriter.end(), [](int pass) { return pass == none; })) return;
  std::vector<Arc> in_place;
  for (std::size_t i = 0; i < draft.passes.size(); ++i) {
    for (const auto& wire : draft.passes[i].wires) {
      if (wire.version == none || overwriter[at(wire.version)] == none) continue;
      const int writer = overwriter[at(wire.version)];
      if (wire.history()) {
        draft.diagnostics->error("in-place-history",
                                 "`" + wire.entry->text + "` cannot be kept for `" + draft.passes[i].name() + "`: `" +
                                     draft.passes[at(writer)].name() + "` overwrites it within the frame",
                                 wire.entry->where, "read what the overwriting pass makes of it");
      } else if (writer != static_cast<int>(i)) {
        in_place.push_back({static_cast<int>(i), writer, nullptr, wire.version});
      }
    }
  }
  draft.order = sorted_or_cut(
      draft,
      [&] {
        Arcs arcs = wire_arcs(draft);
        for (const auto& arc : in_place) arcs.add(arc);
        return arcs;
      },
      [&](const Arc& cut) {
        std::erase_if(in_place, [&](const Arc& arc) {
          return cut.changes != none && arc.from == cut.from && arc.to == cut.to && arc.changes == cut.changes;
        });
      });
}

}  // namespace loom::graph
