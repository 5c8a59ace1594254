#include "support/render.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "loom/diagnostic.h"
#include "plugins/loader.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"

namespace loom::test {
namespace {

class FunctionPass final : public Pass {
 public:
  explicit FunctionPass(PassFunctions functions) : f_(std::move(functions)) {}
  void params(Params& params) override {
    if (f_.params) f_.params(params);
  }
  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    if (f_.reflect) f_.reflect(ports);
  }
  void prepare(Device& device, const Bindings& bindings) override {
    if (f_.prepare) f_.prepare(device, bindings);
  }
  void execute(Frame& frame, const Bindings& bindings) override {
    if (f_.execute) f_.execute(frame, bindings);
  }
  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return f_.fingerprint ? f_.fingerprint(frame) : std::nullopt;
  }

 private:
  PassFunctions f_;
};

graph::CompiledGraph graph_of(graph::CompileResult result) {
  if (!result.graph) throw BadInput(result.diagnostics);
  return std::move(*result.graph);
}

}  // namespace

void add_pass(Registry& registry, std::string type, std::function<PassFunctions()> make) {
  registry.add_pass({.name = std::move(type), .summary = "of a test", .create = [make = std::move(make)] {
                       return std::make_unique<FunctionPass>(make());
                     }});
}

void add_compute(Registry& registry, std::string type, std::string shader, std::function<void(Ports&)> reflect,
                 glm::ivec3 threads) {
  add_pass(registry, std::move(type), [shader = std::move(shader), reflect = std::move(reflect), threads] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{
        .reflect = reflect,
        .prepare = [=](Device& device, const Bindings&) { *program = device.program({.files = {shader}}); },
        .execute =
            [=](Frame& frame, const Bindings& bindings) {
              frame.dispatch(**program, bindings, threads.x > 0 ? threads : glm::ivec3(frame.size(), 1));
            }};
  });
}

void RenderTest::SetUp() {
  GlTest::SetUp();
  if (!IsSkipped()) device_ = make_device();
}

graph::CompiledGraph RenderTest::compile(const std::string& pipeline, const graph::CompileOptions& options) const {
  return graph_of(graph::compile_text(pipeline, "test.json", registry_, {}, options));
}

std::unique_ptr<graph::Renderer> RenderTest::make(const std::string& pipeline, graph::RendererOptions options,
                                                  graph::CompileOptions compile_options) {
  compile_options.frame_size = size_;
  frame_ = 0;
  return graph::Renderer::create(compile(pipeline, compile_options), *device_, options);
}

void RenderTest::frame(graph::Renderer& renderer) { renderer.render(scene_, camera_, {.index = frame_++, .seed = 7}); }

float RenderTest::uniform_value(const graph::Renderer& renderer, std::string_view output) {
  const graph::ReadImage image = renderer.read(output);
  for (const glm::vec4& texel : image.texels) {
    const bool same = texel.x == image.texels[0].x || (std::isnan(texel.x) && std::isnan(image.texels[0].x));
    if (same) continue;
    ADD_FAILURE() << output << " is not uniform: " << texel.x << " and " << image.texels[0].x;
    return std::numeric_limits<float>::quiet_NaN();
  }
  return image.texels[0].x;
}

graph::ReadImage render_text(const std::string& pipeline, const std::string& scene, glm::ivec2 size,
                             const RenderOptions& options) {
  Registry registry;
  Diagnostics diagnostics;
  const plugins::SearchPath search{.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false};
  plugins::load_plugins(search, registry, diagnostics);
  if (diagnostics.has_errors()) throw Error(diagnostics);
  const scene::Setup setup = scene::load_setup(scene, "", diagnostics);
  graph::CompileOptions compile_options{.frame_size = size,
                                        .overrides = options.overrides,
                                        .requested = {options.output},
                                        .alias = options.alias,
                                        .prune = options.prune};
  const SceneFacts facts = scene::compute_facts(setup.scene);
  const bool is_file = std::filesystem::path(pipeline).extension() == ".json";
  graph::CompiledGraph graph =
      graph_of(is_file ? graph::compile_file(pipeline, registry, facts, compile_options)
                       : graph::compile_text(pipeline, "test.json", registry, facts, compile_options));
  const auto device = gpu::CachingDevice::create({.shader_roots = source_shader_roots(), .cache_dir = "-"});
  const auto gpu_scene = scene::GpuScene::create(setup.scene);
  const auto renderer = graph::Renderer::create(std::move(graph), *device, options.renderer);
  const interop::Camera camera = scene::make_camera(setup.camera, setup.scene, size);
  for (int i = 0; i < options.frames; ++i)
    renderer->render(*gpu_scene, camera, {.index = static_cast<std::uint64_t>(i), .seed = options.seed});
  return renderer->read(options.output);
}

}  // namespace loom::test
