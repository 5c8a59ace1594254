#pragma once
// The std140 structs of the bundles: what producers publish, as bytes and as uniform buffers.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "graph/compile/compile.h"
#include "graph/run/storage.h"
#include "loom/gpu.h"

namespace loom::graph {

class BundleStructs {
 public:
  explicit BundleStructs(const CompiledGraph& graph);

  /// `what` names the port for errors. Throws Error where the size is not the bundle type's.
  void publish(int bundle, std::span<const std::byte> data, const std::string& what);
  [[nodiscard]] std::span<const std::byte> data(int bundle, std::size_t bytes, const std::string& what) const;
  /// Null where the bundle type has no struct.
  [[nodiscard]] const Buffer* buffer(int bundle) const;
  /// All bits set, NaN as floats.
  void poison(int bundle);
  /// `x.y@prev` takes what `x.y` held.
  void swap_history();
  /// Copies the structs of history bundles, and of what becomes history, from another graph's.
  Adopted adopt(const BundleStructs& from);
  void reset();

 private:
  struct Entry {
    std::string name, type;
    std::vector<std::byte> bytes;
    std::vector<Buffer> buffer;  ///< one, or none
    int history_of = none;
  };
  std::vector<Entry> entries_;
};

}  // namespace loom::graph
