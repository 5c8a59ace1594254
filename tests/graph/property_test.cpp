// Properties of plans of random graphs, checked against what they mean rather than against how they are made.
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "graph/fakes.h"
#include "graph/random_graph.h"

namespace loom::test {
namespace {

using graph::CompiledGraph;
using Lifetime = graph::Resource::Lifetime;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

struct Case {
  RandomGraph model;
  CompiledGraph graph;
};

Case compiled(unsigned seed, int passes, const graph::CompileOptions& options = {}) {
  static const Registry registry = random_registry();
  Case result{random_graph(seed, passes), {}};
  auto compiled = compile(result.model.text, registry, options);
  if (compiled.graph)
    result.graph = std::move(*compiled.graph);
  else
    ADD_FAILURE() << "seed " << seed << '\n' << text_of(compiled.diagnostics);
  return result;
}

/// Size and seed of each graph.
class RandomGraphs : public testing::TestWithParam<std::pair<int, unsigned>> {
 protected:
  [[nodiscard]] static Case get(const graph::CompileOptions& options = {}) {
    return compiled(GetParam().second, GetParam().first, options);
  }
};

std::vector<std::pair<int, unsigned>> sizes() {
  std::vector<std::pair<int, unsigned>> list;
  for (unsigned seed = 1; seed <= 30; ++seed) list.emplace_back(3 + static_cast<int>(seed), seed);
  for (unsigned seed = 31; seed <= 36; ++seed) list.emplace_back(150, seed);
  list.emplace_back(1000, 37U);
  list.emplace_back(1000, 38U);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomGraphs, testing::ValuesIn(sizes()), [](const auto& instance) {
  return std::to_string(instance.param.first) + "_passes_seed_" + std::to_string(instance.param.second);
});

TEST_P(RandomGraphs, OrderPutsProducersAndOldReadersFirst) {
  const Case c = get();
  std::map<std::string, std::size_t> position;
  for (std::size_t i = 0; i < c.graph.order.size(); ++i) position[c.graph.passes[at(c.graph.order[i])].name] = i;
  EXPECT_EQ(position.size(), c.graph.order.size()) << "a pass runs twice";
  for (const auto& [before, after] : c.model.must_precede) {
    if (position.contains(before) && position.contains(after)) {
      EXPECT_LT(position[before], position[after]) << before << " before " << after;
    }
  }
}

TEST_P(RandomGraphs, OrderFollowsTheFileWhereItIsFree) {
  const Case c = get({.prune = false});
  // The least position in the file among the passes that nothing holds back, at every step.
  std::map<std::string, std::set<std::string>> waits;
  for (const auto& name : c.model.names) waits[name];
  for (const auto& [before, after] : c.model.must_precede) waits[after].insert(before);
  for (const int pass : c.graph.order) {
    const auto free = std::find_if(c.model.names.begin(), c.model.names.end(),
                                   [&](const auto& name) { return waits.contains(name) && waits[name].empty(); });
    ASSERT_NE(free, c.model.names.end());
    ASSERT_EQ(c.graph.passes[at(pass)].name, *free);
    waits.erase(*free);
    for (auto& [name, before] : waits) before.erase(*free);
  }
}

TEST_P(RandomGraphs, ExactlyWhatIsReachableRuns) {
  const Case c = get();
  std::set<std::string> reachable;
  std::vector<std::string> open = c.model.roots;
  while (!open.empty()) {
    const std::string name = open.back();
    open.pop_back();
    if (!reachable.insert(name).second) continue;
    const auto sources = c.model.reads.find(name);
    if (sources != c.model.reads.end()) open.insert(open.end(), sources->second.begin(), sources->second.end());
  }
  std::set<std::string> running;
  for (const auto& pass : c.graph.passes)
    if (pass.runs) running.insert(pass.name);
  EXPECT_EQ(running, reachable);
  std::set<std::string> pruned;
  for (const auto& entry : c.graph.pruned) {
    pruned.insert(entry.what);
    EXPECT_FALSE(entry.why.empty());
  }
  for (const auto& name : c.model.names) EXPECT_NE(pruned.contains(name), reachable.contains(name)) << name;
}

TEST_P(RandomGraphs, WithoutPruningEveryPassRuns) {
  const Case c = get({.prune = false});
  EXPECT_EQ(c.graph.order.size(), c.model.names.size());
}

TEST_P(RandomGraphs, NoTwoResourcesThatLiveAtOnceShareASlot) {
  const Case c = get();
  std::map<int, std::vector<const graph::Resource*>> by_slot;
  for (const auto& resource : c.graph.resources) {
    ASSERT_NE(resource.slot, graph::none) << resource.name;
    EXPECT_LE(resource.first, resource.last) << resource.name;
    EXPECT_LE(resource.bytes, c.graph.slots[at(resource.slot)].bytes) << resource.name;
    by_slot[resource.slot].push_back(&resource);
  }
  for (const auto& [slot, users] : by_slot)
    for (std::size_t i = 0; i < users.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_TRUE(users[i]->last < users[j]->first || users[j]->last < users[i]->first)
            << users[i]->name << " and " << users[j]->name;
        EXPECT_EQ(users[i]->lifetime, Lifetime::transient) << users[i]->name;
        EXPECT_EQ(users[i]->desc.index(), users[j]->desc.index());
        if (std::holds_alternative<TextureDesc>(users[i]->desc)) {
          EXPECT_EQ(users[i]->desc, users[j]->desc);
        }
      }
}

TEST_P(RandomGraphs, LifetimesCoverEveryUse) {
  const Case c = get();
  for (std::size_t i = 0; i < c.graph.order.size(); ++i)
    for (const auto& port : c.graph.passes[at(c.graph.order[i])].bound)
      for (const auto& member : port.members) {
        if (member.resource == graph::none || !member.declared) continue;
        const auto& resource = c.graph.resources[at(member.resource)];
        EXPECT_LE(resource.first, static_cast<int>(i)) << resource.name;
        EXPECT_GE(resource.last, static_cast<int>(i)) << resource.name;
      }
}

/// As many slots of a texture descriptor as there are resources of it alive at once: no fewer can do.
TEST_P(RandomGraphs, SharingIsOptimalPerDescriptor) {
  const Case c = get();
  std::map<std::string, std::vector<const graph::Resource*>> groups;
  for (const auto& resource : c.graph.resources)
    if (const auto* texture = std::get_if<TextureDesc>(&resource.desc))
      if (resource.lifetime == Lifetime::transient)
        groups[to_string(*texture) + std::string(to_string(texture->kind))].push_back(&resource);
  for (const auto& [desc, resources] : groups) {
    std::set<int> slots;
    std::size_t most = 0;
    for (const auto* resource : resources) {
      slots.insert(resource->slot);
      const auto alive = std::count_if(resources.begin(), resources.end(), [&](const auto* other) {
        return other->first <= resource->first && resource->first <= other->last;
      });
      most = std::max(most, static_cast<std::size_t>(alive));
    }
    EXPECT_EQ(slots.size(), most) << desc;
  }
}

/// Replays four frames and checks each access against every earlier one of the same storage, by OpenGL's rule: an
/// access after an incoherent store, and a store after any access, need a barrier in between that names it.
TEST_P(RandomGraphs, BarriersCoverEveryHazard) {
  const Case c = get();
  struct Past {
    Access access;
    unsigned issued = 0;  // barrier bits since
  };
  const auto bit = [](Access access) -> unsigned {
    switch (access) {
      case Access::sampled:
        return graph::barrier_texture_fetch;
      case Access::color:
      case Access::depth:
        return graph::barrier_framebuffer;
      case Access::storage_read:
      case Access::storage_write:
        return graph::barrier_storage;
      default:
        return graph::barrier_image_access;
    }
  };
  const auto stores = [&](Access access) {
    return writes(access) && (bit(access) & (graph::barrier_image_access | graph::barrier_storage)) != 0;
  };
  std::vector<int> storage;  // by resource; swapped with history
  for (const auto& resource : c.graph.resources) storage.push_back(resource.slot);
  // For each storage and each pair of kinds only the oldest bits matter, so one entry an access kind is enough.
  std::vector<std::map<Access, Past>> past(c.graph.slots.size());
  int hazards = 0;
  for (int frame = 0; frame < 4; ++frame) {
    for (const int index : c.graph.order) {
      const auto& pass = c.graph.passes[at(index)];
      for (auto& accesses : past)
        for (auto& [access, entry] : accesses) entry.issued |= pass.barriers;
      std::vector<std::pair<int, Access>> now;
      for (const auto& port : pass.bound)
        for (const auto& member : port.members)
          if (member.resource != graph::none && member.declared)
            now.emplace_back(storage[at(member.resource)], member.access);
      for (const auto& [slot, access] : now)
        for (const auto& [kind, before] : past[at(slot)]) {
          const bool after_store = stores(kind);
          const bool store_after = stores(access);
          if (!after_store && !store_after) continue;
          ++hazards;
          ASSERT_NE(before.issued & bit(access), 0U)
              << pass.name << " accesses slot " << slot << " as " << to_string(access) << " after " << to_string(kind)
              << " in frame " << frame;
        }
      for (const auto& [slot, access] : now) past[at(slot)][access] = {access, 0};
    }
    for (std::size_t r = 0; r < storage.size(); ++r)
      if (c.graph.resources[r].history_of != graph::none)
        std::swap(storage[r], storage[at(c.graph.resources[r].history_of)]);
  }
  if (c.graph.order.size() > 20) {
    EXPECT_GT(hazards, 0) << "the graphs no longer exercise this";
  }
}

TEST_P(RandomGraphs, AliasingNeverCostsMemory) {
  const Case shared = get();
  const Case apart = get({.alias = false});
  EXPECT_LE(shared.graph.bytes, apart.graph.bytes);
  EXPECT_EQ(apart.graph.bytes, apart.graph.bytes_without_aliasing);
  EXPECT_EQ(apart.graph.slots.size(), apart.graph.resources.size());
}

}  // namespace
}  // namespace loom::test
