#pragma once
// One frame in execution: camera, time, seed, scene, and the few GL operations that passes share.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/export.h"
#include "loom/formats.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"

namespace loom {

/// The storage behind a pass's ports, by path: "surface.depth", "scratch.tmp", "persistent.sum".
class LOOM_API Bindings {
 public:
  virtual ~Bindings() = default;
  /// Throws Error naming pass and path where the member is not there; ask has() first for what may be missing.
  [[nodiscard]] virtual const Texture& texture(std::string_view path) const = 0;
  [[nodiscard]] virtual const Buffer& buffer(std::string_view path) const = 0;
  /// True where the member exists: for an output, that somebody reads it; for an input, that the producer makes it.
  [[nodiscard]] virtual bool has(std::string_view path) const = 0;
  /// True where the input is unwired or carries nothing.
  [[nodiscard]] virtual bool absent(std::string_view input) const = 0;
  /// False until a history input holds a frame, and after a reset.
  [[nodiscard]] virtual bool history_valid(std::string_view input) const = 0;
  /// True where the outputs hold what this pass last left in them: it declared keep_outputs(), nobody writes into them,
  /// and they are not new.
  [[nodiscard]] virtual bool kept() const = 0;
  /// A number that is another one whenever the input may bring something else than before. For a pass that keeps parts
  /// of its outputs while one input changes (the camera's) and others do not.
  [[nodiscard]] virtual std::uint64_t revision(std::string_view input) const = 0;

  /// The bundle's std140 struct. A producer publishes it each frame; a consumer reads it or binds it by the block name
  /// `<port>_data`.
  template <class T>
  void publish(std::string_view output, const T& data) const {
    static_assert(std::is_trivially_copyable_v<T>);
    publish_bytes(output, std::as_bytes(std::span(&data, 1)));
  }
  template <class T>
  [[nodiscard]] T data(std::string_view port) const {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, data_bytes(port, sizeof(T)).data(), sizeof(T));
    return value;
  }

 protected:
  virtual void publish_bytes(std::string_view output, std::span<const std::byte> data) const = 0;
  [[nodiscard]] virtual std::span<const std::byte> data_bytes(std::string_view port, std::size_t bytes) const = 0;
};

/// How a draw meets what a colour target holds.
enum class Blend { replace, add };

struct FrameInfo {
  std::uint64_t index = 0;  ///< counts rendered frames since the graph was reset
  double time_s = 0;
  double dt_s = 0;
  std::uint32_t seed = 0;  ///< --seed; mix with `index` and `sample` for per-frame randomness
  int sample = 0;          ///< sub-pixel sample of this frame, 0 … samples−1
  int samples = 1;
};

class LOOM_API Frame {
 public:
  virtual ~Frame() = default;
  [[nodiscard]] virtual const FrameInfo& info() const = 0;
  [[nodiscard]] virtual glm::ivec2 size() const = 0;
  [[nodiscard]] virtual const interop::Camera& camera() const = 0;
  [[nodiscard]] virtual const SceneView& scene() const = 0;

  /// Makes `program` current and binds everything that it names:
  ///   sampler or image uniform `<port>_<member>` (also `scratch_<name>`, `persistent_<name>`) — the texture,
  ///   storage block `<port>_<member>` — the buffer; `scene_*` — the scene's,
  ///   uniform block `<port>_data` — the bundle's struct; `frame_data` — this frame,
  ///   uniform named as a parameter of the pass — its value; of a choice the index.
  /// A sampler of an absent, unmade or undeclared member is an error: guard it by a #define. A shadow sampler
  /// (sampler2DArrayShadow, …) compares reversed depths: 1 where the reference is at least as near as the stored one.
  /// Images are bound whole, level 0. Names that begin with no port's name are the pass's own to bind, `material_*` the
  /// scene's (SceneView::draw); ProgramInterface says at which unit.
  virtual void bind(const Program& program, const Bindings& bindings) = 0;
  /// bind(), then enough work groups to cover `threads`.
  virtual void dispatch(const Program& program, const Bindings& bindings, glm::ivec3 threads) = 0;
  /// bind(), then one triangle over the target, one a layer where it is layered (gl_Layer), without depth test. The
  /// target is what begin_raster() bound in this pass; without, all of the pass's colour outputs, not cleared.
  virtual void fullscreen(const Program& program, const Bindings& bindings) = 0;
  /// Binds the framebuffer made of the pass's outputs, scratch and persistent textures with access color (in order of
  /// declaration; unread ones discard) and depth, whole (arrays, volumes and cubes are layered targets), sets the
  /// viewport, clears colour to 0 (or what cleared() says) and depth to far (0: depth is reversed). In-place outputs
  /// and persistent textures keep what they hold. A depth output that nobody reads still tests. Depth test GREATER
  /// where there is depth; each pass begins with blending, culling and scissor off, clip-space z in [0, 1]. With
  /// nothing to attach, the raster has the frame's size.
  virtual void begin_raster(const Bindings& bindings) = 0;
  /// begin_raster() over the named members alone ("lights.flux", "scratch.depth"); for a pass with several targets.
  virtual void begin_raster(const Bindings& bindings, std::span<const std::string_view> members) = 0;
  /// The same without clearing: what the targets hold stays, for sums over several draws.
  virtual void continue_raster(const Bindings& bindings, std::span<const std::string_view> members) = 0;
  /// For colour target `index` of the raster, until the pass ends.
  virtual void blend(int index, Blend mode) = 0;
  /// bind(), then `count` points without attributes (gl_VertexID) into the target, without depth test.
  virtual void points(const Program& program, const Bindings& bindings, int count) = 0;
  /// Orders memory between two dispatches inside one pass.
  virtual void barrier() = 0;
};

}  // namespace loom
