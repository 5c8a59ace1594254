// Stage 6c: storage. Interval colouring over each set of equal descriptors, which is optimal: as many slots as there
// are resources of that descriptor alive at once.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <queue>
#include <utility>
#include <variant>
#include <vector>

#include "graph/compile/plan.h"

namespace loom::graph {
namespace {

/// Slots of one texture descriptor, the one that is free soonest first.
struct Bucket {
  TextureDesc desc;
  using Use = std::pair<int, int>;  // last position, slot
  std::priority_queue<Use, std::vector<Use>, std::greater<>> uses;
};

class SlotAssignment {
 public:
  explicit SlotAssignment(CompiledGraph& graph) : graph_(graph) {}

  void own(Resource& resource) {
    resource.slot = static_cast<int>(graph_.slots.size());
    graph_.slots.push_back({resource.desc, resource.bytes});
  }

  void shared(Resource& resource) {
    if (const auto* texture = std::get_if<TextureDesc>(&resource.desc))
      shared_texture(resource, *texture);
    else
      shared_buffer(resource);
  }

 private:
  void shared_texture(Resource& resource, const TextureDesc& desc) {
    auto bucket = std::find_if(buckets_.begin(), buckets_.end(), [&](const Bucket& b) { return b.desc == desc; });
    if (bucket == buckets_.end()) bucket = buckets_.insert(buckets_.end(), Bucket{desc, {}});
    if (!bucket->uses.empty() && bucket->uses.top().first < resource.first) {
      resource.slot = bucket->uses.top().second;
      bucket->uses.pop();
    } else {
      own(resource);
    }
    bucket->uses.emplace(resource.last, resource.slot);
  }

  /// The smallest free buffer that is large enough; else the largest free one grows, which costs less than another.
  void shared_buffer(Resource& resource) {
    BufferUse* best = nullptr;
    for (auto& use : buffers_) {
      if (use.last >= resource.first) continue;
      const std::size_t bytes = bytes_of(use);
      const std::size_t best_bytes = best == nullptr ? 0 : bytes_of(*best);
      const bool fits = bytes >= resource.bytes;
      const bool best_fits = best != nullptr && best_bytes >= resource.bytes;
      if (best == nullptr || (fits && (!best_fits || bytes < best_bytes)) || (!best_fits && bytes > best_bytes))
        best = &use;
    }
    if (best == nullptr) {
      own(resource);
      buffers_.push_back({resource.last, resource.slot});
      return;
    }
    resource.slot = best->slot;
    best->last = resource.last;
    Slot& slot = graph_.slots[static_cast<std::size_t>(best->slot)];
    if (slot.bytes < resource.bytes) slot = {resource.desc, resource.bytes};
  }

  struct BufferUse {
    int last, slot;
  };
  [[nodiscard]] std::size_t bytes_of(const BufferUse& use) const {
    return graph_.slots[static_cast<std::size_t>(use.slot)].bytes;
  }

  CompiledGraph& graph_;
  std::vector<Bucket> buckets_;
  std::vector<BufferUse> buffers_;
};

}  // namespace

void assign_slots(CompiledGraph& graph, bool alias) {
  std::vector<Resource*> by_start;
  for (auto& resource : graph.resources)
    if (resource.lifetime != Resource::Lifetime::external) by_start.push_back(&resource);
  std::stable_sort(by_start.begin(), by_start.end(),
                   [](const Resource* a, const Resource* b) { return a->first < b->first; });
  SlotAssignment slots(graph);
  for (Resource* resource : by_start) {
    if (alias && resource->lifetime == Resource::Lifetime::transient)
      slots.shared(*resource);
    else
      slots.own(*resource);
    graph.bytes_without_aliasing += resource->bytes;
  }
  for (const auto& slot : graph.slots) graph.bytes += slot.bytes;
}

}  // namespace loom::graph
