#pragma once
// Pipelines from text, run: with passes made of functions, or with the plugins of the build.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "interop/camera.h"
#include "interop/light.h"
#include "loom/pass.h"
#include "loom/registry.h"
#include "loom/scene_view.h"
#include "support/gl.h"

namespace loom::test {

/// A scene with nothing to draw; what tests set is what passes see.
class EmptyScene : public SceneView {
 public:
  [[nodiscard]] const SceneFacts& facts() const override { return facts_; }
  [[nodiscard]] std::span<const interop::Light> lights() const override { return {}; }
  [[nodiscard]] glm::vec3 sky_radiance() const override { return sky; }
  [[nodiscard]] std::uint64_t geometry_version() const override { return version; }
  [[nodiscard]] std::uint64_t lights_version() const override { return version; }
  void draw(const Program& /*program*/, int /*instances*/, Surfaces /*which*/, Motion /*motion*/) const override {}
  [[nodiscard]] const Buffer* buffer(std::string_view /*block*/) const override { return nullptr; }
  [[nodiscard]] const Texture* texture(std::string_view /*sampler*/) const override { return nullptr; }

  glm::vec3 sky{0};
  std::uint64_t version = 1;

 private:
  SceneFacts facts_;
};

/// A pass made of functions; those that are not set do nothing.
struct PassFunctions {
  std::function<void(Params&)> params;
  std::function<void(Ports&)> reflect;
  std::function<void(Device&, const Bindings&)> prepare;
  std::function<void(Frame&, const Bindings&)> execute;
  std::function<Fingerprint(const Frame&)> fingerprint;
};
/// Each instance gets functions of its own from `make`.
void add_pass(Registry& registry, std::string type, std::function<PassFunctions()> make);
/// A pass that runs one compute shader over the frame (`threads` = the frame's size where it is 0).
void add_compute(Registry& registry, std::string type, std::string shader, std::function<void(Ports&)> reflect,
                 glm::ivec3 threads = glm::ivec3(0));

class RenderTest : public GlTest {
 protected:
  void SetUp() override;
  /// Throws Error with every diagnostic where the pipeline is wrong.
  graph::CompiledGraph compile(const std::string& pipeline, const graph::CompileOptions& options) const;
  /// A frame of size_; outputs as the pipeline names them.
  std::unique_ptr<graph::Renderer> make(const std::string& pipeline, graph::RendererOptions options = {},
                                        graph::CompileOptions compile_options = {});
  /// Frames are numbered by the fixture.
  void frame(graph::Renderer& renderer);
  /// All texels of an output as one number each (red), where they are all equal; NaN and a failure where not.
  static float uniform_value(const graph::Renderer& renderer, std::string_view output = "image");

  Registry registry_;
  EmptyScene scene_;
  interop::Camera camera_{};
  glm::ivec2 size_{16, 8};
  std::unique_ptr<gpu::CachingDevice> device_;
  std::uint64_t frame_ = 0;
};

struct RenderOptions {
  std::string output = "image";
  int frames = 1;
  std::vector<graph::Override> overrides;
  bool alias = true;
  bool prune = true;
  graph::RendererOptions renderer;
  std::uint32_t seed = 0;
};
/// The last frame of a pipeline (text, or the path of a file) over a scene or run file, with the plugins of the build.
/// Throws Error; needs a current context.
graph::ReadImage render_text(const std::string& pipeline, const std::string& scene, glm::ivec2 size,
                             const RenderOptions& options = {});

}  // namespace loom::test
