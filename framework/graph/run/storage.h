#pragma once
// The textures and buffers behind the resources of a plan.
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "graph/compile/compile.h"
#include "loom/gpu.h"

namespace loom::graph {

/// Whether all state of a kind was found elsewhere and taken over; true where there is none.
struct Adopted {
  bool history = true, persistent = true;
};

class Storage {
 public:
  /// Allocates every slot, cleared to zero. `graph` must outlive this. Throws Error naming what does not fit.
  explicit Storage(const CompiledGraph& graph);

  /// Null where the resource is a buffer, or an external input that has not been set.
  [[nodiscard]] const Texture* texture(int resource) const;
  [[nodiscard]] const Buffer* buffer(int resource) const;

  /// Persistent and history resources get their first values.
  void reset();
  /// What each history pair calls this frame and the last one changes places.
  void swap_history();
  /// Copies history and persistent resources of equal name and description from another graph's storage.
  Adopted adopt(const Storage& from) const;
  /// The clear that a resource asks for before its producer runs.
  void clear(int resource) const;
  /// NaN into floats, all bits into integers and buffers, 1 into normalised formats.
  void poison(int resource) const;

  /// The resource of `inputs.<name>.<member>`; throws BadInput naming the nearest, or where `desc` or the texture
  /// itself does not fit the declaration.
  void set_external(std::string_view name, std::string_view member, GlName texture, const TextureDesc& desc);
  /// Throws Error that names an external input which was never set.
  void require_externals() const;

 private:
  [[nodiscard]] const Resource& at(int resource) const;
  void copy(const Storage& from, int source, int target) const;

  using Object = std::variant<std::monostate, Texture, Buffer>;
  const CompiledGraph& graph_;
  std::vector<Object> slots_;
  std::vector<Buffer> views_;      ///< by resource: its part of a slot that larger buffers share
  std::vector<int> slot_of_;       ///< by resource; swapped between history pairs
  std::vector<Object> externals_;  ///< by resource
};

}  // namespace loom::graph
