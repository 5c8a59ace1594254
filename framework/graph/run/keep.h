#pragma once
// Which passes may keep the outputs of an earlier frame.
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "graph/compile/compile.h"
#include "loom/frame.h"

namespace loom::graph {

/// A pass keeps its outputs where it declared keep_outputs(), its fingerprint() and parameters are what they were when
/// it last ran, and every pass upstream kept its own. What comes from outside or from the last frame counts as changed.
class KeepTracker {
 public:
  explicit KeepTracker(const CompiledGraph& graph);
  void begin_frame();
  /// Asked in order of execution, each pass that runs once.
  bool may_keep(int pass, const Frame& frame);
  /// A pass made its outputs anew.
  void ran(int pass);
  /// The pass's outputs are as it left them.
  [[nodiscard]] bool kept(const CompiledPass& pass) const;
  /// How often what the input brings was made anew; every frame, where it comes from outside or from the last frame.
  [[nodiscard]] std::uint64_t revision(const CompiledPass& pass, std::string_view input) const;
  /// The next frame runs everything.
  void forget();

 private:
  struct State {
    std::optional<std::uint64_t> fingerprint;
    std::vector<ParamValue> params;
    bool changed = true;  ///< in this frame
    std::uint64_t runs = 0;
    bool made = false;  ///< its outputs, since all was forgotten
  };
  [[nodiscard]] bool upstream_changed(int pass) const;
  [[nodiscard]] std::uint64_t revision(int producer) const;
  const CompiledGraph& graph_;
  std::vector<State> states_;               ///< by pass
  std::vector<std::vector<int>> upstream_;  ///< by pass: who it reads from; none: something that always changes
  std::uint64_t frames_ = 0;
};

}  // namespace loom::graph
