#pragma once
// Which probes are awake: those that some pixel has read since what they see last changed.
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "interop/probes.h"
#include "loom/frame.h"
#include "loom/gpu.h"

namespace field {

class Sleepers {
 public:
  /// `find_readers`: shaders/radiance_field/readers.comp.
  explicit Sleepers(std::shared_ptr<const loom::Program> find_readers) : find_readers_(std::move(find_readers)) {}

  /// The probes to be captured now. All others that are awake were captured for the same `seen`, a number that stands
  /// for everything that probes see. Where it is another one than before, or the field is new, all fall asleep first.
  std::vector<std::int32_t> wake(loom::Frame& frame, const loom::Bindings& bindings,
                                 const loom::interop::ProbeGrid& grid, std::uint64_t seen);

 private:
  std::shared_ptr<const loom::Program> find_readers_;
  std::optional<std::uint64_t> seen_;
};

}  // namespace field
