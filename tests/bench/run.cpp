// What running a graph costs beyond the GL calls that its passes make: frames of N passes that do nothing, that only
// bind, and the same GL calls without a graph.
#include <benchmark/benchmark.h>
#include <epoxy/gl.h>

#include <memory>
#include <string>
#include <utility>

#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/gl_state.h"
#include "graph/run/renderer.h"
#include "support/gl.h"
#include "support/render.h"

namespace {

using namespace loom;

constexpr const char* shader = R"(
layout(local_size_x = 1) in;
uniform sampler2D before_image;
uniform float scale;
layout(rgba16f) writeonly uniform image2D image_image;
void main() { if (scale == 1e30) imageStore(image_image, ivec2(0), texelFetch(before_image, ivec2(0), 0)); }
)";

// A chain of `passes` passes; `binds`: each makes its program current with a sampler, an image and a uniform.
struct Chain {
  Chain(int passes, bool binds) {
    dir.write("bind.comp", shader);
    device = gpu::CachingDevice::create({.shader_roots = {dir.path()}, .cache_dir = "-"});
    const auto image = TextureDesc::image({8, 8}, Format::rgba16f);
    test::add_pass(registry, "First", [=] {
      return test::PassFunctions{
          .reflect = [=](Ports& p) { p.out("image", "Image").texture("image", image, Access::image_write); }};
    });
    test::add_pass(registry, "Next", [=] {
      struct State {
        float scale = 1;
        std::shared_ptr<const Program> program;
      };
      const auto state = std::make_shared<State>();
      return test::PassFunctions{
          .params = [=](Params& p) { p.real("scale", state->scale, {.min = 0, .max = 2}); },
          .reflect =
              [=](Ports& p) {
                p.in("before", "Image").reads("image");
                p.out("image", "Image").texture("image", image, Access::image_write);
              },
          .prepare = [=](Device& d, const Bindings&) { state->program = d.program({.files = {"bind.comp"}}); },
          .execute =
              [=](Frame& frame, const Bindings& bindings) {
                if (binds) frame.bind(*state->program, bindings);
              }};
    });
    std::string text = R"({ "passes": { "p0": { "type": "First" })";
    for (int i = 1; i < passes; ++i)
      text += ", \"p" + std::to_string(i) + R"(": { "type": "Next", "in": { "before": "p)" + std::to_string(i - 1) +
              R"(.image" } })";
    text += R"(}, "outputs": { "image": "p)" + std::to_string(passes - 1) + R"(.image" } })";
    auto compiled = graph::compile_text(text, "bench.json", registry, {}, {.frame_size = {8, 8}});
    if (!compiled.graph) throw Error(compiled.diagnostics);
    renderer = graph::Renderer::create(std::move(*compiled.graph), *device, {.wait = false});
  }

  test::TempDir dir;
  Registry registry;
  std::unique_ptr<gpu::CachingDevice> device;
  std::unique_ptr<graph::Renderer> renderer;
  test::EmptyScene scene;
};

void frames(benchmark::State& state, bool binds) {
  const auto passes = static_cast<int>(state.range(0));
  Chain chain(passes, binds);
  const interop::Camera camera{};
  std::uint64_t index = 0;
  for (auto _ : state) chain.renderer->render(chain.scene, camera, {.index = index++});
  state.counters["per_pass"] = benchmark::Counter(
      static_cast<double>(passes), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void empty_passes(benchmark::State& state) { frames(state, false); }
void binding_passes(benchmark::State& state) { frames(state, true); }

// The GL calls that binding_passes makes for each pass, straight.
void bare_gl_calls(benchmark::State& state) {
  test::TempDir dir;
  dir.write("bind.comp", shader);
  const auto device = gpu::CachingDevice::create({.shader_roots = {dir.path()}, .cache_dir = "-"});
  const auto program = device->program({.files = {"bind.comp"}});
  const Texture a(TextureDesc::image({8, 8}, Format::rgba16f), "a"),
      b(TextureDesc::image({8, 8}, Format::rgba16f), "b");
  GLuint query = 0;
  glCreateQueries(GL_TIMESTAMP, 1, &query);
  const GLint location = program->interface().uniforms.at(0).location_or_binding;
  for (auto _ : state) {
    for (int i = 0; i < state.range(0); ++i) {
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
      glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, 4, "pass");
      graph::set_known_state();
      glUseProgram(program->name());
      glBindTextureUnit(0, (i & 1) != 0 ? a.name() : b.name());
      glBindSampler(0, 0);
      glBindImageTexture(0, (i & 1) != 0 ? b.name() : a.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
      glProgramUniform1f(program->name(), location, 1);
      glPopDebugGroup();
      glQueryCounter(query, GL_TIMESTAMP);
    }
  }
  glDeleteQueries(1, &query);
  state.counters["per_pass"] = benchmark::Counter(
      static_cast<double>(state.range(0)), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(empty_passes)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(binding_passes)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(bare_gl_calls)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
