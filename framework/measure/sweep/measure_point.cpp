#include "measure/sweep/measure_point.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "core/image_io.h"
#include "gpu/context.h"
#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "loom/diagnostic.h"
#include "measure/bootstrap.h"
#include "measure/colormap.h"
#include "measure/flicker.h"
#include "measure/metrics.h"
#include "measure/sampling.h"
#include "measure/sweep/truth.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"
#include "scene/world.h"

namespace loom::measure {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Of all threads of this process: a software driver's time, little touched by what else the machine does.
double process_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    const double rank = q * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(rank);
    const double next = values[std::min(low + 1, values.size() - 1)];
    return values[low] + (rank - static_cast<double>(low)) * (next - values[low]);
  };
  return {at(.5), at(.95)};
}

graph::CompiledGraph compile(const PointJob& job, const SceneFacts& facts, std::vector<std::string> requested) {
  const SweepScene& scene = job.sweep.scenes[job.point.scene];
  graph::CompileOptions options;
  options.frame_size = size_of(job.sweep, scene);
  options.overrides = job.point.set;
  options.requested = std::move(requested);
  graph::CompileResult result =
      graph::compile_file(job.sweep.pipelines[job.point.entry].path, job.registry, facts, options);
  if (!result.graph) throw BadInput(result.diagnostics);
  return std::move(*result.graph);
}

/// What can be asked of this pipeline beside `image`, `hdr` and `indirect`.
std::vector<std::string> outputs_of(const PointJob& job, const SceneFacts& facts) {
  std::vector<std::string> outputs = {"image", "hdr", "indirect"};
  const graph::CompiledGraph all = compile(job, facts, {});
  const auto named = [&](const char* name) {
    return std::any_of(all.outputs.begin(), all.outputs.end(), [&](const auto& o) { return o.name == name; });
  };
  if (named("bounce")) outputs.emplace_back("bounce");
  if (job.sweep.settings.flicker && all.pass("gbuffer") != nullptr) outputs.emplace_back("gbuffer.surface.depth");
  return outputs;
}

ImageLayers layers_of(const graph::ReadImage& image) {
  ImageLayers layers{.width = image.width, .height = image.height, .channels = {}, .attributes = {}};
  constexpr std::array<const char*, 3> names = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    std::vector<float>& channel = layers.channels[names[static_cast<std::size_t>(c)]];
    channel.reserve(image.texels.size());
    for (const glm::vec4& texel : image.texels) channel.push_back(texel[c]);
  }
  return layers;
}

/// Pictures of one seed, by output.
using Pictures = std::map<std::string, graph::ReadImage>;

/// Renders frames as `loom render` does and times them.
class Shots {
 public:
  Shots(const PointJob& job, const scene::Setup& setup, const scene::GpuScene& gpu_scene, graph::Renderer& renderer,
        std::vector<std::string> outputs)
      : settings_(job.sweep.settings),
        setup_(setup),
        box_(scene::world_box(setup.scene)),
        size_(size_of(job.sweep, job.sweep.scenes[job.point.scene])),
        gpu_scene_(gpu_scene),
        renderer_(renderer),
        outputs_(std::move(outputs)),
        offsets_(jitter(settings_.samples)) {}

  struct FrameTime {
    double wall_ms = 0, cpu_ms = 0;
  };

  /// One frame with all its samples; its pictures where they are wanted.
  FrameTime frame(std::uint32_t seed, Pictures* pictures) {
    FrameTime time;
    std::map<std::string, Mean> means;
    for (std::size_t sample = 0; sample < offsets_.size(); ++sample) {
      const FrameInfo info{.index = index_++,
                           .time_s = 0,
                           .dt_s = 0,
                           .seed = seed,
                           .sample = static_cast<int>(sample),
                           .samples = settings_.samples};
      const auto camera = scene::make_camera(setup_.camera, box_, size_, offsets_[sample]);
      const double cpu = process_cpu_s();
      const auto start = Clock::now();
      renderer_.render(gpu_scene_, camera, info);
      time.wall_ms += 1e3 * seconds_since(start);
      time.cpu_ms += 1e3 * (process_cpu_s() - cpu);
      if (pictures == nullptr) continue;
      for (const std::string& output : outputs_) means[output].add(renderer_.read(output));
    }
    frames_s_ += 1e-3 * time.wall_ms;
    if (pictures != nullptr) {
      for (const auto& [output, mean] : means) (*pictures)[output] = mean.image();
    }
    return time;
  }

  /// One sample of a frame from a camera that has moved.
  void moved_frame(const scene::Camera& camera, FlickerProbe& probe) {
    const FrameInfo info{.index = index_++, .seed = 0, .sample = 0, .samples = 1};
    const auto block = scene::make_camera(camera, box_, size_);
    const auto start = Clock::now();
    renderer_.render(gpu_scene_, block, info);
    frames_s_ += seconds_since(start);
    probe.add(block, renderer_.read("gbuffer.surface.depth"), renderer_.read("indirect"));
  }

  void reset() {
    renderer_.reset();
    index_ = 0;
  }
  [[nodiscard]] double frames_s() const { return frames_s_; }
  [[nodiscard]] double diagonal() const { return box_.diagonal(); }

 private:
  const Settings& settings_;
  const scene::Setup& setup_;
  scene::Box box_;
  glm::ivec2 size_;
  const scene::GpuScene& gpu_scene_;
  graph::Renderer& renderer_;
  std::vector<std::string> outputs_;
  std::vector<glm::dvec2> offsets_;
  std::uint64_t index_ = 0;
  double frames_s_ = 0;
};

/// Frames of one seed are alike but where something is carried from one to the next.
bool has_state(const graph::CompiledGraph& graph) {
  return std::any_of(graph.resources.begin(), graph.resources.end(), [](const graph::Resource& r) {
    return r.lifetime == graph::Resource::Lifetime::history || r.lifetime == graph::Resource::Lifetime::persistent;
  });
}

double flicker_of(Shots& shots, const scene::Setup& setup, const FlickerPath& path) {
  scene::Camera camera = setup.camera;
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 step =
      shots.diagonal() * (path.move.x * right + path.move.y * glm::cross(right, forward) + path.move.z * forward);
  FlickerProbe probe;
  shots.reset();
  for (int i = 0; i < path.frames; ++i) {
    shots.moved_frame(camera, probe);
    camera.eye += step;
    camera.target += step;
  }
  return probe.value();
}

/// (a−r)²/(r²+1e-2) of each pixel, mean over its channels and over the seeds; NaN where a picture is not finite.
std::vector<double> relative_errors(const std::vector<ImageFile>& pictures, const Layer& reference) {
  std::vector<double> errors(reference.pixels(), 0);
  const double share = 1. / (static_cast<double>(pictures.size()) * static_cast<double>(reference.planes.size()));
  for (const ImageFile& picture : pictures) {
    const Layer a = find_layer(picture, "RGB");
    for (std::size_t c = 0; c < reference.planes.size(); ++c) {
      for (std::size_t i = 0; i < errors.size(); ++i) {
        const double r = reference.planes[c][i], difference = static_cast<double>(a.planes[c][i]) - r;
        errors[i] += share * difference * difference / (r * r + 1e-2);
      }
    }
  }
  for (double& error : errors) {
    if (!std::isfinite(error)) error = std::numeric_limits<double>::quiet_NaN();
  }
  return errors;
}

OutputError error_of(const std::vector<Pictures>& seeds, const std::string& output, const ImageFile& truth,
                     const std::string& heatmap) {
  const Layer reference = find_layer(truth, output == "hdr" ? "RGB" : output);
  std::vector<ImageFile> pictures;
  pictures.reserve(seeds.size());
  for (const Pictures& seed : seeds)
    pictures.push_back({.path = output, .image = layers_of(seed.at(output)), .hdr = true});
  OutputError error;
  double sum = 0, squares = 0;
  for (const ImageFile& picture : pictures) {
    const Metrics metrics = compute_metrics(find_layer(picture, "RGB"), reference);
    sum += metrics.relmse;
    squares += metrics.relmse * metrics.relmse;
    error.mean_ratio += metrics.mean_ratio / static_cast<double>(pictures.size());
    error.non_finite += metrics.non_finite;
  }
  const auto n = static_cast<double>(pictures.size());
  error.relmse = sum / n;
  if (n > 1) error.seed_sd = std::sqrt(std::max(0., (squares - sum * sum / n) / (n - 1)));
  const Interval interval = block_bootstrap(relative_errors(pictures, reference), reference.width, reference.height);
  error.low = interval.low;
  error.high = interval.high;
  const FlipMap flip = flip_hdr(find_layer(pictures.front(), "RGB"), reference);
  error.flip = flip.mean;
  if (!heatmap.empty()) write_heatmap(heatmap, flip.width, flip.height, flip.error);
  return error;
}

void write_picture(const std::string& path, const graph::ReadImage& image) {
  std::vector<glm::vec3> pixels;
  pixels.reserve(image.texels.size());
  for (const glm::vec4& texel : image.texels) pixels.emplace_back(texel);
  write_png(path, image.width, image.height, pixels);
}

}  // namespace

Result describe(const Sweep& sweep, const Point& point) {
  const Settings& settings = sweep.settings;
  const SweepScene& scene = sweep.scenes[point.scene];
  const SweepEntry& entry = sweep.pipelines[point.entry];
  Result result{.key = point.key, .scene = scene.name, .camera = scene.camera, .pipeline = entry.name};
  result.pipeline_path = entry.path;
  for (const graph::Override& o : point.set) result.set.emplace_back(o.pass + '.' + o.param, o.value);
  result.size = size_of(sweep, scene);
  result.samples = settings.samples;
  result.frames = settings.frames;
  result.seeds = settings.seeds;
  result.keep_static = settings.keep_static;
  return result;
}

Result measure_point(const PointJob& job) {
  const auto start = Clock::now();
  const Settings& settings = job.sweep.settings;
  const SweepScene& scene = job.sweep.scenes[job.point.scene];
  Result result = describe(job.sweep, job.point);
  result.version = job.version;
  Diagnostics warnings;
  const scene::Setup setup = scene::load_setup(scene.path, scene.camera, warnings);
  const SceneFacts facts = scene::compute_facts(setup.scene);
  const Truth truth = obtain_truth(job.truth_folder, setup, result.size, settings.truth);
  result.truth = truth.id;
  result.content = content_of(job.sweep, job.point, truth.id, job.shader_roots);

  // What a plain render of the picture takes: the outputs that are measured would be kept alive longer.
  const graph::CompiledGraph plain = compile(job, facts, {"image"});
  result.bytes = plain.bytes;
  result.bytes_without_aliasing = plain.bytes_without_aliasing;
  const std::vector<std::string> outputs = outputs_of(job, facts);
  graph::CompiledGraph graph = compile(job, facts, outputs);
  const bool stateful = has_state(graph);
  result.no_indirect = std::any_of(graph.outputs.begin(), graph.outputs.end(),
                                   [](const auto& o) { return o.name == "indirect" && o.endpoint.empty(); });
  const gpu::Context context = gpu::Context::headless();
  const auto device = gpu::CachingDevice::create({.shader_roots = job.shader_roots, .cache_dir = {}});
  result.device = device->description();
  const auto gpu_scene = scene::GpuScene::create(setup.scene);
  const auto renderer = graph::Renderer::create(std::move(graph), *device, {.fingerprints = settings.keep_static});
  result.load_s = seconds_since(start);

  Shots shots(job, setup, *gpu_scene, *renderer, outputs);
  std::vector<Pictures> seeds(static_cast<std::size_t>(settings.seeds));
  std::vector<double> wall_ms, cpu_ms, anew_ms;
  result.first_ms = shots.frame(0, nullptr).wall_ms;
  for (int i = 0; i < settings.frames; ++i) {
    const Shots::FrameTime time = shots.frame(0, i + 1 == settings.frames ? &seeds.front() : nullptr);
    wall_ms.push_back(time.wall_ms);
    cpu_ms.push_back(time.cpu_ms);
  }
  const graph::FrameTimes times = renderer->frame_times();
  for (std::size_t seed = 1; seed < seeds.size(); ++seed) {
    shots.reset();
    const int more = stateful ? settings.frames : 0;
    for (int i = 0; i <= more; ++i) {
      const double ms = shots.frame(static_cast<std::uint32_t>(seed), i == more ? &seeds[seed] : nullptr).wall_ms;
      if (i == 0) anew_ms.push_back(ms);
    }
  }
  if (std::find(outputs.begin(), outputs.end(), "gbuffer.surface.depth") != outputs.end()) {
    result.flicker = flicker_of(shots, setup, *settings.flicker);
  }
  result.frames_s = shots.frames_s();
  result.wall_ms = spread_of(wall_ms);
  result.cpu_ms = spread_of(cpu_ms);
  result.gpu_ms = {times.gpu_median_ms * settings.samples, times.gpu_p95_ms * settings.samples};
  if (!anew_ms.empty()) result.anew_ms = spread_of(anew_ms).median;

  const std::string picture = (std::filesystem::path(job.pictures) / job.point.key).string();
  for (const std::string& output : outputs) {
    if (output != "hdr" && output != "indirect" && output != "bounce") continue;
    const bool mapped = output == "hdr" && !job.pictures.empty();
    result.errors[output] = error_of(seeds, output, truth.file, mapped ? picture + ".error.png" : std::string());
  }
  if (!job.pictures.empty()) write_picture(picture + ".png", seeds.front().at("image"));
  result.rest_s = seconds_since(start) - result.load_s - result.frames_s;
  return result;
}

}  // namespace loom::measure
