#pragma once
// Runs a compiled graph: allocates its slots, prepares its passes, executes frames, measures them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "graph/compile/compile.h"
#include "interop/camera.h"
#include "loom/export.h"
#include "loom/frame.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"

namespace loom::graph {

/// Milliseconds of one pass over the measured frames. The first frame (warm-up) is left out where there are more.
struct PassTimes {
  std::string name, type;
  double gpu_median_ms = 0, gpu_p95_ms = 0, cpu_median_ms = 0;
};
/// The same of one frame.
struct PassCost {
  std::string name;
  double gpu_ms = 0, cpu_ms = 0;
};
struct FrameTimes {
  double wall_median_ms = 0, gpu_median_ms = 0, cpu_median_ms = 0, gpu_p95_ms = 0;
};

struct RendererOptions {
  bool poison = false;        ///< fill transients with NaN before each frame: undeclared reads show (tests)
  bool fingerprints = true;   ///< keep outputs whose fingerprint did not change
  bool check_finite = false;  ///< count non-finite and negative texels of every output after every pass
  /// render() returns when the GPU is done, so that FrameTimes::wall_median_ms is what a frame takes. Without, frames
  /// overlap and the wall time is that of submitting one: what a program with its own frame loop wants.
  bool wait = true;
};

/// What a change of a parameter came to.
enum class ParamChange {
  applied,        ///< in effect from the next frame on
  needs_compile,  ///< cost `graph`, or the pass would declare other ports: compile with it as an override
  refused,        ///< see the diagnostics; nothing changed
};

/// Numbers in one output after its pass ran. Only outputs that had any are reported, in the order they were made.
struct FiniteReport {
  std::string pass, member;
  std::uint64_t frame = 0, non_finite = 0, negative = 0;
  bool non_negative = false;  ///< an amount of light: `negative` must be 0
};

/// An image read back: RGBA floats, row 0 at the top.
struct ReadImage {
  int width = 0, height = 0, layers = 1;
  std::vector<glm::vec4> texels;
  std::string quantity;
};

class LOOM_API Renderer {
 public:
  /// Takes the graph; `device` must outlive the renderer. Throws Error naming the pass that could not be prepared.
  static std::unique_ptr<Renderer> create(CompiledGraph graph, Device& device, RendererOptions options = {});
  virtual ~Renderer() = default;

  virtual void render(const SceneView& scene, const interop::Camera& camera, const FrameInfo& info) = 0;
  /// Clears history and persistent state, as after loading.
  virtual void reset() = 0;
  /// Takes over the history and persistent state of another renderer, by name, where the descriptions are equal: for
  /// going on after a new compilation. True where nothing was left to start anew.
  virtual bool adopt_state(const Renderer& other) = 0;
  /// The texture of a compiled output ("image", "hdr", "gbuffer.surface.depth"), or null where it is absent (zero).
  [[nodiscard]] virtual const Texture* output(std::string_view name) const = 0;
  /// The texture behind an entry of graph().resources, or null where that is a buffer or has not been set. A transient
  /// one holds what the last pass left in its slot; outputs, history and persistent ones keep their content.
  [[nodiscard]] virtual const Texture* resource(int index) const = 0;
  /// The buffer behind an entry of graph().resources, or null where that is a texture; what it holds: as above.
  [[nodiscard]] virtual const Buffer* buffer(int index) const = 0;
  /// The std140 struct of an entry of graph().bundles as last published; empty where its type has none.
  [[nodiscard]] virtual std::span<const std::byte> bundle_data(int index) const = 0;
  /// Reads an output back; an absent one is zero at frame size.
  [[nodiscard]] virtual ReadImage read(std::string_view name) const = 0;
  /// Hands an external texture to `inputs.<name>` of the pipeline, as `member`; it must fit the declaration.
  virtual void set_input(std::string_view name, std::string_view member, GlName texture, const TextureDesc& desc) = 0;
  /// The std140 struct of an external input.
  virtual void set_input_data(std::string_view name, std::span<const std::byte> data) = 0;
  /// `--set pass.param=text` on the running graph. A `shader` parameter prepares the pass again; throws Error where
  /// that fails, with the old value back in place.
  virtual ParamChange set_param(std::string_view pass, std::string_view param, std::string_view text,
                                Diagnostics& diagnostics) = 0;
  /// Prepares every pass again: after Device programs were invalidated (hot reload).
  virtual void prepare_again() = 0;

  [[nodiscard]] virtual const CompiledGraph& graph() const = 0;
  [[nodiscard]] virtual std::vector<PassTimes> pass_times() const = 0;
  /// Of the newest frame that was measured; cheap enough to ask every frame.
  [[nodiscard]] virtual std::vector<PassCost> newest_costs() const = 0;
  [[nodiscard]] virtual FrameTimes frame_times() const = 0;
  [[nodiscard]] virtual std::vector<FiniteReport> finite_reports() const = 0;
  /// Passes that kept their outputs in the last frame.
  [[nodiscard]] virtual std::vector<std::string> kept_passes() const = 0;
};

}  // namespace loom::graph
