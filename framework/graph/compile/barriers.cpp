// Stage 6d: memory barriers. OpenGL orders rendering and texture fetches by itself; what shaders write by image store
// or into storage buffers it orders only by glMemoryBarrier, whose bits name the kind of access that comes after.
#include <cstddef>
#include <utility>
#include <vector>

#include "graph/compile/plan.h"

namespace loom::graph {
namespace {

constexpr unsigned stores = barrier_image_access | barrier_storage;
constexpr unsigned all_bits =
    barrier_texture_fetch | barrier_image_access | barrier_storage | barrier_framebuffer | barrier_update;

unsigned bit_of(Access access) {
  switch (access) {
    case Access::sampled:
      return barrier_texture_fetch;
    case Access::image_read:
    case Access::image_write:
    case Access::image_read_write:
      return barrier_image_access;
    case Access::color:
    case Access::depth:
      return barrier_framebuffer;
    case Access::storage_read:
    case Access::storage_write:
      break;
  }
  return barrier_storage;
}

/// Which barriers a slot's next access still needs, by kind of that access.
struct Hazards {
  unsigned read = 0;   ///< to see what was stored
  unsigned write = 0;  ///< to come after what was read or written

  [[nodiscard]] unsigned needed(Access access) const {
    const unsigned bit = bit_of(access);
    return bit & (writes(access) ? read | write : read);
  }
  void record(Access access) {
    const unsigned bit = bit_of(access);
    if ((bit & stores) != 0 && writes(access)) {
      read = all_bits;
      write = stores | barrier_framebuffer | barrier_update;
    } else if ((bit & stores) != 0) {
      write |= stores | barrier_framebuffer | barrier_update;  // an image load is not ordered before later rendering
    } else {
      write |= stores;  // fetches and rendering are ordered before all but stores
    }
  }
  void issued(unsigned bits) {
    read &= ~bits;
    write &= ~bits;
  }
};

struct Touch {
  std::size_t storage;
  Access access;
  bool clears;
};

class BarrierPlacement {
 public:
  explicit BarrierPlacement(CompiledGraph& graph) : graph_(graph) {
    std::size_t externals = 0;
    for (const auto& resource : graph.resources)
      storage_.push_back(resource.slot != none ? static_cast<std::size_t>(resource.slot)
                                               : graph.slots.size() + externals++);
    hazards_.resize(graph.slots.size() + externals);
    touches_.reserve(graph.order.size());
    for (const int pass : graph.order) touches_.push_back(touches_of(graph.passes[static_cast<std::size_t>(pass)]));
  }

  void run() {
    // The second frame meets what the first left behind; more frames meet no more than that.
    for (int frame = 0; frame < 2; ++frame) {
      for (std::size_t i = 0; i < touches_.size(); ++i)
        play(touches_[i], graph_.passes[static_cast<std::size_t>(graph_.order[i])].barriers);
      for (std::size_t r = 0; r < graph_.resources.size(); ++r)
        if (graph_.resources[r].history_of != none)
          std::swap(hazards_[storage_[r]],
                    hazards_[storage_[static_cast<std::size_t>(graph_.resources[r].history_of)]]);
    }
  }

 private:
  [[nodiscard]] std::vector<Touch> touches_of(const CompiledPass& pass) const {
    std::vector<Touch> touches;
    for (const auto& port : pass.bound)
      for (const auto& member : port.members) {
        if (member.resource == none || !member.declared) continue;
        const auto resource = static_cast<std::size_t>(member.resource);
        touches.push_back(
            {storage_[resource], member.access, !port.is_input && graph_.resources[resource].clear_each_frame});
      }
    return touches;
  }

  void play(const std::vector<Touch>& touches, unsigned& barriers) {
    for (const auto& touch : touches) {
      barriers |= hazards_[touch.storage].needed(touch.access);
      if (touch.clears) barriers |= (hazards_[touch.storage].read | hazards_[touch.storage].write) & barrier_update;
    }
    if (barriers != 0)
      for (auto& hazards : hazards_) hazards.issued(barriers);
    for (const auto& touch : touches) hazards_[touch.storage].record(touch.access);
  }

  CompiledGraph& graph_;
  std::vector<std::size_t> storage_;  // by resource
  std::vector<Hazards> hazards_;      // by storage
  std::vector<std::vector<Touch>> touches_;
};

}  // namespace

void place_barriers(CompiledGraph& graph) { BarrierPlacement(graph).run(); }

}  // namespace loom::graph
