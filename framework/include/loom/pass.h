#pragma once
// The interface that every render pass implements.
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/facts.h"
#include "loom/frame.h"
#include "loom/gpu.h"
#include "loom/json.h"
#include "loom/params.h"
#include "loom/ports.h"

namespace loom {

/// Equal values on two frames: the outputs of the first may be kept. Empty: run every frame.
using Fingerprint = std::optional<std::uint64_t>;

class LOOM_API Pass {
 public:
  Pass() = default;
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;
  virtual ~Pass();

  /// JSON keys beside type, in and params that this pass reads itself (the Shader pass: file, ports, uniforms).
  [[nodiscard]] virtual std::span<const std::string_view> own_keys() const { return {}; }
  /// Reads those keys from the pass's object; called once, before params(). Relative paths are relative to the file
  /// that `node.where` names.
  virtual void configure(const json::Node& /*pass_object*/, Diagnostics& /*diagnostics*/) {}

  /// Declares the parameters; called once, after construction.
  virtual void params(Params& /*params*/) {}
  /// Declares inputs, outputs and state for this scene. Pure: no OpenGL, may run often, no effect but on `ports`.
  virtual void reflect(Ports& ports, const SceneFacts& facts) = 0;
  /// Makes GL objects; after every (re)allocation and after a change of a `shader` parameter.
  virtual void prepare(Device& /*device*/, const Bindings& /*bindings*/) {}
  virtual void execute(Frame& frame, const Bindings& bindings) = 0;
  /// Asked only where reflect() called keep_outputs(). Parameters and upstream changes are the executor's to watch:
  /// name here what else the outputs depend on (scene versions, camera).
  [[nodiscard]] virtual Fingerprint fingerprint(const Frame& /*frame*/) const { return std::nullopt; }
};

}  // namespace loom
