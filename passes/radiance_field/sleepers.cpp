#include "sleepers.h"

#include <cstddef>
#include <span>

#include "probe_grid.h"

namespace field {

std::vector<std::int32_t> Sleepers::wake(loom::Frame& frame, const loom::Bindings& bindings,
                                         const loom::interop::ProbeGrid& grid, std::uint64_t seen) {
  const loom::Buffer &captured = bindings.buffer("persistent.captured"), &cells = bindings.buffer("scratch.read_cells");
  if (!bindings.kept() || seen_ != seen) {
    captured.clear();
    bindings.buffer("persistent.states").clear();  // off
  }
  seen_ = seen;
  cells.clear();
  frame.dispatch(*find_readers_, bindings, {frame.size(), 1});
  frame.barrier();
  const int count = grid.counts.x * grid.counts.y * grid.counts.z;
  std::vector<std::uint32_t> done(static_cast<std::size_t>(count)), read(done.size());
  captured.read(std::as_writable_bytes(std::span(done)));
  cells.read(std::as_writable_bytes(std::span(read)));
  std::vector<std::int32_t> probes;
  for (const std::int32_t probe : read_by(grid, read)) {
    if (std::exchange(done[static_cast<std::size_t>(probe)], 1u) == 0) probes.push_back(probe);
  }
  captured.write(std::as_bytes(std::span(done)));
  return probes;
}

}  // namespace field
