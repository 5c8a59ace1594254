// loom render: one scene through one pipeline to pictures, and what it cost.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/compile_arguments.h"
#include "cli/json_out.h"
#include "cli/output_image.h"
#include "cli/progress.h"
#include "core/image_io.h"
#include "gpu/context.h"
#include "gpu/device.h"
#include "graph/run/renderer.h"
#include "measure/picture.h"
#include "measure/sampling.h"
#include "scene/gpu_scene.h"

namespace loom::cli {
namespace {

struct Arguments {
  CompileArguments compile;
  std::string out, output, stats;
  int samples = 1;
  int frames = 1;
  double dt_s = 1. / 60;
  std::uint32_t seed = 0;
  bool check_finite = false;
  std::uint64_t max_memory = 0;  ///< bytes, 0 = no limit
};

/// Throws where the plan takes more than the user allows, naming what is largest.
void check_memory(const graph::CompiledGraph& graph, std::uint64_t allowed) {
  if (allowed == 0 || graph.bytes <= allowed) return;
  std::vector<const graph::Resource*> largest;
  for (const graph::Resource& resource : graph.resources) largest.push_back(&resource);
  std::sort(largest.begin(), largest.end(), [](const auto* a, const auto* b) { return a->bytes > b->bytes; });
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(largest.size(), 5); ++i) {
    names += (i == 0 ? "" : ", ") + largest[i]->name + " " + bytes_text(largest[i]->bytes);
  }
  throw bad_input("over-memory",
                  "the plan takes " + bytes_text(graph.bytes) + " of textures and buffers, --max-memory allows " +
                      bytes_text(allowed) + " (" + bytes_text(graph.bytes - allowed) + " too much)",
                  "largest: " + names + "; a smaller --size or grid shrinks them, see loom plan");
}

Json stats_json(const graph::Renderer& renderer, const std::string& device) {
  Json document = versioned();
  Json& passes = document["passes"] = Json::array();
  for (const graph::PassTimes& pass : renderer.pass_times()) {
    passes.push_back({{"name", pass.name},
                      {"type", pass.type},
                      {"gpu_ms", {{"median", pass.gpu_median_ms}, {"p95", pass.gpu_p95_ms}}},
                      {"cpu_ms", pass.cpu_median_ms}});
  }
  const graph::FrameTimes frame = renderer.frame_times();
  document["frame"] = {
      {"wall_ms", frame.wall_median_ms}, {"gpu_ms", frame.gpu_median_ms}, {"cpu_ms", frame.cpu_median_ms}};
  const graph::CompiledGraph& graph = renderer.graph();
  document["memory"] = {{"textures_bytes", graph.bytes}, {"without_aliasing_bytes", graph.bytes_without_aliasing}};
  document["device"] = device;
  Json& pruned = document["pruned"] = Json::array();
  for (const graph::Pruned& p : graph.pruned) pruned.push_back({{"what", p.what}, {"why", p.why}});
  for (const Decision& d : graph.decisions) {
    if (d.rule == "unread") continue;  // is there already
    const std::string where = d.pass.empty() ? "" : d.pass + ": ";
    pruned.push_back({{"what", where + d.decision}, {"why", d.rule + ": " + d.evidence}});
  }
  return document;
}

/// Throws where a pass made NaN or infinity, or negative light: the first that did comes first.
void check_finite(const graph::Renderer& renderer) {
  Diagnostics diagnostics;
  const std::vector<graph::FiniteReport> reports = renderer.finite_reports();
  for (const graph::FiniteReport& r : reports) {
    const bool negative_light = r.non_negative && r.negative > 0;
    if (r.non_finite == 0 && !negative_light) continue;
    const bool first = !diagnostics.has_errors();
    diagnostics.error(r.non_finite > 0 ? "not-finite" : "negative-light",
                      r.pass + "." + r.member + " in frame " + std::to_string(r.frame) + ": " +
                          std::to_string(r.non_finite) + " numbers are not finite, " + std::to_string(r.negative) +
                          " are negative",
                      {}, first ? "`" + r.pass + "` is the first pass that made one" : "");
  }
  if (diagnostics.has_errors()) throw Error(diagnostics);
}

/// The camera after the scene moved: the file's own camera moves with it.
scene::Camera camera_now(const scene::Setup& setup) {
  if (!setup.camera.name.empty()) {
    for (const scene::Camera& camera : setup.scene.cameras) {
      if (camera.name == setup.camera.name) return camera;
    }
  }
  return setup.camera;
}

/// Renders all frames; writes those that are wanted. Returns the renderer, for its figures.
class Job {
 public:
  Job(const Arguments& arguments, const OutputPath& path, scene::Setup& setup, const std::string& output)
      : arguments_(arguments),
        path_(path),
        setup_(setup),
        output_(output),
        offsets_(measure::jitter(arguments.samples)) {}

  void run(graph::Renderer& renderer, scene::GpuScene& gpu_scene, glm::ivec2 size) {
    Progress progress("frame", static_cast<std::uint64_t>(arguments_.frames) * offsets_.size());
    for (int frame = 0; frame < arguments_.frames; ++frame) {
      const double time_s = frame * arguments_.dt_s;
      if (scene::pose(setup_.scene, time_s)) gpu_scene.update();
      const bool wanted = path_.each_frame() || frame + 1 == arguments_.frames;
      measure::Mean mean;
      for (std::size_t sample = 0; sample < offsets_.size(); ++sample) {
        const FrameInfo info{.index = index_++,
                             .time_s = time_s,
                             .dt_s = frame > 0 && sample == 0 ? arguments_.dt_s : 0,
                             .seed = arguments_.seed,
                             .sample = static_cast<int>(sample),
                             .samples = arguments_.samples};
        renderer.render(gpu_scene, scene::make_camera(camera_now(setup_), setup_.scene, size, offsets_[sample]), info);
        if (wanted) mean.add(renderer.read(output_));
        progress.show(index_);
      }
      if (arguments_.check_finite) check_finite(renderer);
      if (wanted) measure::write_image(path_.of_frame(frame), path_.is_png(), mean.image(), output_);
    }
  }

 private:
  const Arguments& arguments_;
  const OutputPath& path_;
  scene::Setup& setup_;
  const std::string& output_;
  std::vector<glm::dvec2> offsets_;
  std::uint64_t index_ = 0;
};

/// What the picture shows, where that is not obvious from the command line.
void explain(const graph::CompiledGraph& graph, bool png) {
  const graph::GraphOutput& output = graph.outputs.front();
  if (output.absent) note(output.name + " carries nothing (" + *output.absent + "): the picture is black");
  if (png && output.quantity != "display") {
    note(output.name + " is " + (output.quantity.empty() ? "not display-referred" : output.quantity) +
         ", not tone-mapped: the PNG clamps it to [0, 1] and encodes it as sRGB; -o x.exr keeps the values");
  }
}

void run(const Arguments& arguments, const Session& session) {
  const OutputPath path(arguments.out);
  // A tone-mapped picture for the eye, radiance for measuring.
  const std::string output = !arguments.output.empty() ? arguments.output : path.is_png() ? "image" : "hdr";
  if (!arguments.stats.empty() && arguments.stats != "-") {
    const std::filesystem::path folder = std::filesystem::path(arguments.stats).parent_path();
    std::error_code ignored;
    if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
      throw bad_usage("--stats " + arguments.stats + ": the folder " + folder.string() + " does not exist");
    }
  }

  const Registry registry = load_registry(session);
  LoadedScene scene =
      load_scene(arguments.compile.scene, arguments.compile.camera, arguments.compile.surfaces, arguments.compile.load);
  graph::CompileOptions options = compile_options(arguments.compile, scene.setup);
  options.requested = {output};
  const glm::ivec2 size = options.frame_size;
  const bool keep = options.prune && std::find(options.disabled_rules.begin(), options.disabled_rules.end(),
                                               "static") == options.disabled_rules.end();
  graph::CompiledGraph graph = compile(pipeline_of(arguments.compile, scene.setup), registry, scene.facts, options);
  check_memory(graph, arguments.max_memory);
  explain(graph, path.is_png());

  const gpu::Context context = gpu::Context::headless();
  const auto device =
      gpu::CachingDevice::create({.shader_roots = plugins::shader_roots(session.search()), .cache_dir = {}});
  const auto gpu_scene = scene::GpuScene::create(scene.setup.scene);
  const auto renderer = graph::Renderer::create(std::move(graph), *device,
                                                {.fingerprints = keep, .check_finite = arguments.check_finite});
  Job(arguments, path, scene.setup, output).run(*renderer, *gpu_scene, size);

  if (!arguments.stats.empty()) {
    const std::string text = text_of(stats_json(*renderer, device->description()));
    if (arguments.stats == "-") {
      std::fwrite(text.data(), 1, text.size(), stdout);
    } else {
      write_file_atomic(arguments.stats, std::as_bytes(std::span(text)));
    }
  }
}

}  // namespace

void add_render(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("render", "Render a scene with a pipeline to PNG or EXR");
  const auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  add_compile_options(*command, a.compile);
  command->add_option("-o,--out", a.out, "Picture to write (.png, .exr); out_%04d.png writes every frame")->required();
  command->add_option("--output", a.output,
                      "image, hdr, indirect, bounce, or pass.port.member; default: image to PNG, hdr to EXR");
  command->add_option("--samples", a.samples, "Samples a pixel, averaged over its area")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->add_option("--frames", a.frames, "Frames to render; the last is written")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--dt", a.dt_s, "Seconds from one frame to the next")->check(CLI::Range(0., 1e6));
  command->add_option("--seed", a.seed, "Seed of every random choice")->capture_default_str();
  command->add_option("--stats", a.stats, "Write times and memory as JSON to this file (- for stdout)");
  command->add_flag("--check-finite", a.check_finite, "Fail where a pass makes NaN, infinity or negative light");
  command->add_option("--max-memory", a.max_memory, "Refuse a plan that takes more bytes (K, M, G: powers of 1024)")
      ->transform(CLI::AsSizeValue(false));
  add_json_option(*command, session);
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
