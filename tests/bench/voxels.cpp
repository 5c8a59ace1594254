// CPU time of voxelization by the number of triangles, and of marching by rays and by cells.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "loom/registry.h"
#include "plugins/loader.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"
#include "scene/scene.h"
#include "support/gl.h"
#include "support/scene_builders.h"

namespace {

using namespace loom;

/// A sphere of about 4·rings² triangles in a closed box, a light beside it.
scene::Scene sphere_in_a_box(int rings) {
  scene::Scene scene;
  scene.materials = {test::diffuse(glm::vec3(.5F))};
  test::add_box(scene, {-2, -2, -2}, {2, 2, 2}, 0, true);
  test::add_sphere(scene, {0, 0, 0}, 1, rings, 0);
  test::add_point_light(scene, {1.5, 1.5, 1.5}, glm::vec3(5));
  test::finish(scene);
  return scene;
}

/// The same beside a small sphere of 224 triangles that crosses the box.
scene::Scene with_one_that_moves(int rings) {
  scene::Scene scene = sphere_in_a_box(rings);
  test::add_sphere(scene, {-1.5F, 1.5F, 0}, .3F, 8, 0);
  const int node = scene.instances.back().node;
  scene.animations = {{.channels = {{.node = node, .times = {0, 1}, .values = {glm::vec4(0), {3, 0, 0, 0}}}}}};
  return scene;
}

struct Run {
  /// `keep`: what need not be done again is not, as in a run without --no-prune=static.
  Run(const std::string& text, const scene::Scene& made, glm::ivec2 size, std::vector<graph::Override> set, bool keep)
      : scene(made), gpu_scene(scene::GpuScene::create(scene)) {
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, registry, diagnostics);
    device = gpu::CachingDevice::create({.shader_roots = test::source_shader_roots(), .cache_dir = "-"});
    std::vector<std::string> rules;
    if (!keep) rules.emplace_back("static");
    auto compiled = graph::compile_text(text, "bench.json", registry, scene::compute_facts(scene),
                                        {.frame_size = size, .overrides = std::move(set), .disabled_rules = rules});
    if (!compiled.graph) throw Error(compiled.diagnostics);
    renderer = graph::Renderer::create(std::move(*compiled.graph), *device, {.fingerprints = keep});
    camera = scene::make_camera(test::look_at({1.7, 1.2, 1.5}, {0, 0, 0}), scene, size);
    frame();
  }
  void frame(std::uint32_t seed = 0) { renderer->render(*gpu_scene, camera, {.index = index++, .seed = seed}); }

  scene::Scene scene;
  std::unique_ptr<scene::GpuScene> gpu_scene;
  Registry registry;
  std::unique_ptr<gpu::CachingDevice> device;
  std::unique_ptr<graph::Renderer> renderer;
  interop::Camera camera{};
  std::uint64_t index = 0;
};

void measure(benchmark::State& state, Run& run) {
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    run.frame();
    state.SetIterationTime(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
}

// Sheets alone, 32³: the light on them does not depend on the triangles.
const char* const sheets = R"({ "passes": { "voxelize": { "type": "Voxelize", "params": { "grid": 32 } } },
                                "outputs": { "image": "voxelize.voxels.coverage" } })";

void voxelize(benchmark::State& state) {
  const auto rings = static_cast<int>(state.range(0));
  Run run(sheets, sphere_in_a_box(rings), {8, 8}, {}, false);
  state.counters["triangles"] = static_cast<double>(4 * rings * (rings - 1) + 12);
  measure(state, run);
}

// The same while 224 triangles more move: everything anew in each frame, or only those.
void voxelize_moving(benchmark::State& state) {
  Run run(sheets, with_one_that_moves(static_cast<int>(state.range(0))), {8, 8}, {}, state.range(1) != 0);
  state.counters["triangles"] = static_cast<double>(run.gpu_scene->facts().triangles);
  double time = 0;
  for (auto _ : state) {
    scene::pose(run.scene, time += .01);
    run.gpu_scene->update();
    const std::clock_t start = std::clock();
    run.frame();
    state.SetIterationTime(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
}

/// Area of one side of every sheet of every cell, in cell faces, by texel of `albedo`.
std::vector<float> shown_areas(const Run& run) {
  std::vector<float> areas;
  for (const glm::vec4& texel : run.renderer->output("image")->read()) areas.push_back(texel.a);
  return areas;
}

// The ways of slicing and combining, beside exact areas: time, and of what a sheet shows of its cell the mean absolute
// error as a share of the mean, and the share that lies in cells where nothing was found.
void slicing(benchmark::State& state) {
  constexpr const char* ways[] = {"area", "fragment", "geometry"};
  constexpr const char* operators[] = {"sum", "or", "max"};
  const std::string text = R"({ "passes": { "voxelize": { "type": "Voxelize", "params": { "grid": 32 } } },
                                "outputs": { "image": "voxelize.voxels.albedo" } })";
  const scene::Scene scene = sphere_in_a_box(static_cast<int>(state.range(0)));
  const Run exact(text, scene, {8, 8}, {}, false);
  Run run(text, scene, {8, 8},
          {{"voxelize", "slicing", ways[state.range(1)]}, {"voxelize", "combine", operators[state.range(2)]}}, false);
  const std::vector<float> right = shown_areas(exact), found = shown_areas(run);
  double sum = 0, error = 0, missed = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    sum += right[i];
    error += std::abs(found[i] - right[i]);
    missed += found[i] == 0 ? right[i] : 0;
  }
  state.SetLabel(std::string(ways[state.range(1)]) + " " + operators[state.range(2)]);
  state.counters["error"] = error / sum;
  state.counters["missed"] = missed / sum;
  measure(state, run);
}

// 128² pixels. Everything but the rays is kept from the first frame.
void march(benchmark::State& state) {
  Run run(R"({ "passes": {
      "gbuffer": { "type": "GBuffer" },
      "voxelize": { "type": "Voxelize" },
      "march": { "type": "RayMarch", "in": { "surface": "gbuffer.surface", "voxels": "voxelize.voxels" } } },
    "outputs": { "image": "march.irradiance" } })",
          sphere_in_a_box(32), {128, 128},
          {{"march", "rays", std::to_string(state.range(0))}, {"voxelize", "grid", std::to_string(state.range(1))}},
          true);
  state.counters["rays"] = static_cast<double>(128 * 128 * state.range(0));
  measure(state, run);
}

// Injection of 6·256² texels of a point light and propagation over 16 steps, 32³. Another seed in each frame makes both
// run again, while the light layers, which alone depend on the triangles, are kept.
void inject_and_propagate(benchmark::State& state) {
  Run run(R"({ "passes": {
      "rsm": { "type": "RSM", "params": { "size": 256 } },
      "inject": { "type": "Inject", "in": { "lights": "rsm.lights" }, "params": { "grid": 32 } },
      "lpv": { "type": "LPV", "in": { "flux": "inject.flux", "blockers": "inject.blockers" } } },
    "outputs": { "image": "lpv.intensity" } })",
          sphere_in_a_box(static_cast<int>(state.range(0))), {8, 8}, {{"lpv", "iterations", "16"}}, true);
  state.counters["triangles"] = static_cast<double>(run.gpu_scene->facts().triangles);
  std::uint32_t seed = 0;
  for (auto _ : state) {
    const std::clock_t start = std::clock();
    run.frame(++seed);
    state.SetIterationTime(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    if (run.renderer->kept_passes() != std::vector<std::string>{"rsm"}) state.SkipWithError("the wrong passes ran");
  }
}

BENCHMARK(inject_and_propagate)->Arg(32)->Arg(64)->Arg(128)->Arg(256)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(voxelize)->Arg(32)->Arg(64)->Arg(128)->Arg(256)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(voxelize_moving)
    ->ArgNames({"rings", "apart"})
    ->ArgsProduct({{32, 64, 128, 256}, {0, 1}})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(slicing)
    ->ArgNames({"rings", "slicing", "combine"})
    ->ArgsProduct({{32, 128}, {0, 1, 2}, {0, 1, 2}})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(march)
    ->Args({4, 32})
    ->Args({16, 32})
    ->Args({64, 32})
    ->Args({16, 16})
    ->Args({16, 64})
    ->Args({16, 128})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
