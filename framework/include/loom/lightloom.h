#pragma once
// Lightloom inside another program: a scene and a pipeline rendered in the program's own OpenGL context, with its
// textures as inputs and the results handed back as textures. See docs/embedding.cpp.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/diagnostic.h"
#include "loom/export.h"
#include "loom/formats.h"
#include "loom/gpu.h"

namespace loom {

struct SessionOptions {
  /// Make a headless context (EGL) and keep it current on this thread. Otherwise one of 4.5 core must be current.
  bool own_context = false;
  std::vector<std::string> plugin_dirs;  ///< searched before the installation's own
  std::vector<std::string> shader_dirs;  ///< the same for shaders
  std::string cache_dir;                 ///< of program binaries; empty: the user's, "-": none
};

/// A perspective view; metres.
struct View {
  glm::vec3 eye{0, 0, 1}, target{0}, up{0, 1, 0};
  float yfov_rad = .6859f;
};

/// A texture that the program supplies as member of `inputs.<input>`, of the bundle type that the pipeline declares.
struct ExternalInput {
  std::string input, type, member;
  TextureDesc desc;
};

struct PipelineOptions {
  glm::ivec2 size{0};                                    ///< of the frame; 0: the scene's, else 512x512
  std::vector<std::pair<std::string, std::string>> set;  ///< "pass.param", value as after --set
  std::vector<std::string> outputs;                      ///< what is wanted; empty = all that the pipeline names
  /// Needed where the pipeline's own "inputs" do not say member and format.
  std::vector<ExternalInput> inputs;
};

/// A texture that belongs to the session, valid until the next load, resize or change of a parameter. Rows from the
/// bottom, as OpenGL has them.
struct OutputTexture {
  GlName texture = 0;  ///< 0: absent, which counts as zero everywhere
  TextureDesc desc;
  std::string quantity;  ///< "display" (sRGB-encoded), "radiance", "irradiance", …
};

/// One scene and one pipeline. Several may live side by side, in one context or in several; each is used with the
/// context current in which it was opened, also when it is destroyed. Nothing is global but the log.
///
/// render() restores program, framebuffers, vertex array, viewport and the state of blending, depth, culling, scissor
/// and clip control; what is bound to texture, sampler, image and buffer binding points is not restored.
///
/// Everything throws BadInput for what the caller must mend and Error for failures; both carry all diagnostics.
class LOOM_API Session {
 public:
  static Session open(SessionOptions options = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// A .gltf, .glb or run file; empty: the built-in Cornell box. Lights, camera and sky come with it.
  void load_scene(const std::string& path);
  /// A file, a shipped pipeline's name, or JSON text (begins with `{`); empty: the run file's. After load_scene().
  void load_pipeline(const std::string& pipeline, PipelineOptions options = {});
  /// Compiles again for another frame size. External inputs have to be set again.
  void resize(glm::ivec2 size);
  /// `--set path=value`, path being "pass.param". Compiles again where the parameter asks for it.
  void set(const std::string& path, const std::string& value);

  void set_view(const View& view);
  /// The texture of an external input, borrowed until it is replaced.
  void set_input(std::string_view input, std::string_view member, GlName texture, const TextureDesc& desc);
  /// The std140 struct of an external input's bundle (shaders/interop).
  void set_input_data(std::string_view input, std::span<const std::byte> data);

  /// One frame. `time_s` moves what is animated.
  void render(double time_s = 0, std::uint32_t seed = 0);
  /// Forgets history and accumulated state.
  void reset();

  [[nodiscard]] OutputTexture output(std::string_view name = "image") const;
  /// Read back as RGBA; row 0 is the top one.
  [[nodiscard]] std::vector<glm::vec4> read(std::string_view name = "image") const;
  [[nodiscard]] glm::ivec2 size() const;
  /// Median GPU time of a frame so far, milliseconds.
  [[nodiscard]] double gpu_ms() const;
  /// Warnings and notes of everything so far.
  [[nodiscard]] const Diagnostics& diagnostics() const;

 private:
  struct State;
  explicit Session(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace loom
