// CPU time of one step of light propagation, 32³ cells of three channels, and of injecting 256k points.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "interop/grid.h"
#include "loom/diagnostic.h"
#include "plugins/loader.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"
#include "support/bench.h"
#include "support/gl.h"
#include "support/render.h"

namespace {

using namespace loom;

// A lit room of walls on every sixteenth face, in a grid of n³.
void add_source(Registry& registry, int n) {
  test::add_pass(registry, "Source", [n] {
    return test::PassFunctions{
        .reflect =
            [n](Ports& ports) {
              auto flux = ports.out("flux", "ShVolume");
              for (const char* channel : {"red", "green", "blue"}) {
                flux.texture(channel, TextureDesc::volume(n, Format::rgba32f), Access::image_write);
              }
              auto blockers = ports.out("blockers", "VoxelScene");
              TextureDesc volume = TextureDesc::volume(n, Format::rgba32f, Filter::nearest);
              blockers.texture("occupancy", volume, Access::image_write);
              volume.depth *= 3;
              blockers.texture("albedo", volume, Access::image_write);
            },
        .execute =
            [n](Frame&, const Bindings& io) {
              interop::Grid grid{};
              grid.cells = {n, n, n, 1};
              grid.cascade[0] = {0, 0, 0, 1};
              io.publish("flux", grid);
              std::vector<glm::vec4> cells(static_cast<std::size_t>(n * n * n));
              for (std::size_t i = 0; i < cells.size(); i += 7) cells[i] = {1, .3F, -.5F, .7F};
              for (const char* channel : {"red", "green", "blue"}) {
                io.texture("flux." + std::string(channel)).write(std::as_bytes(std::span(cells)));
              }
              if (!io.has("blockers.occupancy")) return;
              io.publish("blockers", grid);
              for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = glm::vec4(i % 16 == 0 ? 1 : 0);
              io.texture("blockers.occupancy").write(std::as_bytes(std::span(cells)));
              io.texture("blockers.albedo").clear(glm::vec4(.5F));
            }};
  });
}

struct Propagation {
  Propagation(int n, int iterations, bool blockers, const std::string& method) {
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, registry, diagnostics);
    add_source(registry, n);
    device = gpu::CachingDevice::create({.shader_roots = test::source_shader_roots(), .cache_dir = "-"});
    const std::string text = R"({"passes": { "source": {"type": "Source"},
      "lpv": {"type": "LPV", "in": {"flux": "source.flux")" +
                             std::string(blockers ? R"(, "blockers": "source.blockers")" : "") +
                             R"(}, "params": {"method": ")" + method + R"(", "iterations": )" +
                             std::to_string(iterations) +
                             R"(}}}, "outputs": {"image": "lpv.intensity.red", "green": "lpv.intensity.green",
                             "blue": "lpv.intensity.blue"}})";
    auto compiled = graph::compile_text(text, "bench.json", registry, {}, {.frame_size = {8, 8}});
    if (!compiled.graph) throw Error(compiled.diagnostics);
    renderer = graph::Renderer::create(std::move(*compiled.graph), *device, {});
  }
  Registry registry;
  std::unique_ptr<gpu::CachingDevice> device;
  std::unique_ptr<graph::Renderer> renderer;
  test::EmptyScene scene;
};

// What 33 steps take beyond one, over 32.
void step(benchmark::State& state, bool blockers, const std::string& method) {
  const auto n = static_cast<int>(state.range(0));
  Propagation one(n, 1, blockers, method), many(n, 33, blockers, method);
  std::uint64_t index = 0;
  for (auto _ : state) {
    std::array<double, 2> ms{};
    for (std::size_t i = 0; i < 2; ++i) {
      auto& run = i == 0 ? one : many;
      const std::clock_t start = std::clock();
      run.renderer->render(run.scene, interop::Camera{}, {.index = index});
      ms[i] = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    }
    ++index;
    state.SetIterationTime(std::max(1e-9, (ms[1] - ms[0]) / 32 * 1e-3));
  }
}
void compute(benchmark::State& state) { step(state, false, "compute"); }
void compute_blockers(benchmark::State& state) { step(state, true, "compute"); }
void fragment(benchmark::State& state) { step(state, false, "fragment"); }
void fragment_blockers(benchmark::State& state) { step(state, true, "fragment"); }

// 512² texels of one spot light: flux and blockers. The map itself is kept from the first frame on.
void inject(benchmark::State& state, const std::string& method) {
  Registry registry;
  Diagnostics diagnostics;
  plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, registry, diagnostics);
  const auto device = gpu::CachingDevice::create({.shader_roots = test::source_shader_roots(), .cache_dir = "-"});
  test::SceneBuilder builder;
  builder.box(glm::vec3(-1), glm::vec3(1), builder.material(glm::vec3(.5F)));
  const scene::Scene scene = builder.spot({0, .9F, 0}, {0, -1, 0}, glm::vec3(5), .5, .9).build();
  const auto gpu_scene = scene::GpuScene::create(scene);
  auto compiled = graph::compile_text(
      R"({"passes": { "rsm": {"type": "RSM", "params": {"size": 512, "shadow_size": 1}},
      "inject": {"type": "Inject", "in": {"lights": "rsm.lights"}, "params": {"grid": 32, "method": ")" +
          method + R"("}}}, "outputs": {"image": "inject.flux.red", "green": "inject.flux.green",
      "blue": "inject.flux.blue", "occupancy": "inject.blockers.occupancy", "albedo": "inject.blockers.albedo"}})",
      "bench.json", registry, scene::compute_facts(scene), {.frame_size = {8, 8}});
  if (!compiled.graph) throw Error(compiled.diagnostics);
  const auto renderer = graph::Renderer::create(std::move(*compiled.graph), *device, {});
  std::uint64_t index = 0;
  renderer->render(*gpu_scene, interop::Camera{}, {.index = index++});
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    // Another seed: Inject runs anew.
    renderer->render(*gpu_scene, interop::Camera{}, {.index = index, .seed = static_cast<std::uint32_t>(index)});
    ++index;
    state.SetIterationTime(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
}
void inject_atomics(benchmark::State& state) { inject(state, "compute"); }
void inject_points(benchmark::State& state) { inject(state, "points"); }

BENCHMARK(compute)->Arg(32)->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(compute_blockers)->Arg(32)->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(fragment)->Arg(32)->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(fragment_blockers)->Arg(32)->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(inject_atomics)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(inject_points)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
