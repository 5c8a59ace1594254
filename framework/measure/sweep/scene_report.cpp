#include "measure/sweep/scene_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include <epoxy/gl.h>
#include <nlohmann/json.hpp>

#include "core/data_dir.h"
#include "core/image_io.h"
#include "gpu/context.h"
#include "gpu/device.h"
#include "graph/compile/compile.h"
#include "graph/run/renderer.h"
#include "loom/diagnostic.h"
#include "measure/sampling.h"
#include "scene/gpu_scene.h"

namespace loom::measure {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// So many samples stand for the mean over the pixel.
constexpr int aliasing_samples = 256;

Json errors_json(const TruthErrors& e) { return {{"hdr", e.hdr}, {"indirect", e.indirect}, {"bounce", e.bounce}}; }
TruthErrors errors_from(const Json& json) { return {json.at("hdr"), json.at("indirect"), json.at("bounce")}; }

std::string file_of(const std::string& folder, const SceneReport& report, const char* ending) {
  return (fs::path(folder) / (scene_stem(report) + ending)).string();
}

void write(const std::string& folder, const SceneReport& r) {
  Json json = {{"version", 1},
               {"scene", r.name},
               {"camera", r.camera},
               {"size", {r.size.x, r.size.y}},
               {"samples", r.samples},
               {"reference", {{"id", r.truth}, {"spp", r.spp}, {"seconds", r.seconds}, {"noise_relmse", r.noise}}},
               {"without_indirect_relmse", errors_json(r.without_indirect)},
               {"aliasing_relmse", r.aliasing},
               {"device", r.device}};
  Json& list = json["reference"]["convergence"] = Json::array();
  for (const Truth::Step& s : r.convergence) {
    list.push_back({{"spp", s.spp}, {"seconds", s.seconds}, {"relmse", s.relmse}});
  }
  const std::string text = json.dump(2) + "\n";
  write_file_atomic(file_of(folder, r, ".json"), std::as_bytes(std::span(text)));
}

std::optional<SceneReport> read(const std::string& path) {
  std::ifstream in(path);
  if (!in) return std::nullopt;
  try {
    const Json json = Json::parse(in);
    SceneReport r{.name = json.at("scene"), .camera = json.at("camera")};
    r.size = {json.at("size").at(0), json.at("size").at(1)};
    r.samples = json.at("samples");
    const Json& reference = json.at("reference");
    r.truth = reference.at("id");
    r.spp = reference.at("spp");
    r.seconds = reference.at("seconds");
    r.noise = reference.at("noise_relmse");
    for (const Json& s : reference.at("convergence")) {
      r.convergence.push_back({.spp = s.at("spp"), .seconds = s.at("seconds"), .relmse = s.at("relmse")});
    }
    r.without_indirect = errors_from(json.at("without_indirect_relmse"));
    r.aliasing = json.at("aliasing_relmse");
    r.device = json.at("device");
    return r;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

graph::CompiledGraph must(graph::CompileResult result) {
  if (!result.graph) throw Error(result.diagnostics);
  return std::move(*result.graph);
}

/// Rasterised pictures with few and with many samples a pixel, of what every pipeline shares: straight punctual light
/// and emission, and albedo under one irradiance everywhere, the mean of the reference's indirect light. Their relMSE.
double measure_aliasing(const SceneJob& job, const scene::Setup& setup, const Truth& truth, Device& device) {
  const Layer indirect = find_layer(truth.file, "indirect");
  glm::dvec3 ambient(0);
  for (int c = 0; c < 3; ++c) {
    for (const float value : indirect.planes[static_cast<std::size_t>(c)]) ambient[c] += static_cast<double>(value);
    ambient[c] /= static_cast<double>(indirect.pixels());
  }
  const std::string direct = (fs::path(data_dir()) / "pipelines" / "direct.json").string();
  graph::CompiledGraph graph =
      must(graph::compile_file(direct, job.registry, scene::compute_facts(setup.scene),
                               {.frame_size = job.size, .requested = {"hdr", "gbuffer.surface.albedo"}}));
  const auto gpu_scene = scene::GpuScene::create(setup.scene);
  const auto renderer = graph::Renderer::create(std::move(graph), device);
  std::uint64_t frame = 0;
  const auto picture = [&](int samples) {
    std::vector<glm::dvec3> sum(static_cast<std::size_t>(job.size.x) * static_cast<std::size_t>(job.size.y));
    for (const glm::dvec2& offset : jitter(samples)) {
      renderer->render(*gpu_scene, scene::make_camera(setup.camera, setup.scene, job.size, offset), {.index = frame++});
      const graph::ReadImage radiance = renderer->read("hdr"), albedo = renderer->read("gbuffer.surface.albedo");
      for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += (glm::dvec3(radiance.texels[i]) + glm::dvec3(albedo.texels[i]) / std::numbers::pi * ambient) /
                  static_cast<double>(samples);
      }
    }
    return sum;
  };
  const std::vector<glm::dvec3> few = picture(job.settings.samples), many = picture(aliasing_samples);
  double error = 0;
  for (std::size_t i = 0; i < few.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      error += std::pow(few[i][c] - many[i][c], 2) / (many[i][c] * many[i][c] + 1e-2) / 3;
    }
  }
  return error / static_cast<double>(few.size());
}

/// The reference as the pass Tonemap shows it by default.
void write_picture(const std::string& path, const SceneJob& job, const Truth& truth, const scene::Setup& setup,
                   Device& device) {
  constexpr const char* pipeline = R"({
    "inputs": { "hdr": { "type": "Image", "format": "rgba32f" } },
    "passes": { "tonemap": { "type": "Tonemap", "in": { "hdr": "inputs.hdr" } } },
    "outputs": { "image": "tonemap.image" } })";
  graph::CompiledGraph graph =
      must(graph::compile_text(pipeline, "tonemap", job.registry, SceneFacts{}, {.frame_size = job.size}));
  const auto renderer = graph::Renderer::create(std::move(graph), device);
  const Layer radiance = find_layer(truth.file, "RGB");
  std::vector<glm::vec4> texels(radiance.pixels(), glm::vec4(1));
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const std::size_t width = static_cast<std::size_t>(radiance.width), row = i / width;
    const std::size_t from = (static_cast<std::size_t>(radiance.height) - 1 - row) * width + i % width;
    for (int c = 0; c < 3; ++c) texels[i][c] = radiance.planes[static_cast<std::size_t>(c)][from];
  }
  GLuint texture = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  glTextureStorage2D(texture, 1, GL_RGBA32F, job.size.x, job.size.y);
  glTextureSubImage2D(texture, 0, 0, 0, job.size.x, job.size.y, GL_RGBA, GL_FLOAT, texels.data());
  renderer->set_input("hdr", "image", texture, TextureDesc::image(job.size, Format::rgba32f));
  const auto gpu_scene = scene::GpuScene::create(setup.scene);
  renderer->render(*gpu_scene, scene::make_camera(setup.camera, setup.scene, job.size), {});
  const graph::ReadImage image = renderer->read("image");
  glDeleteTextures(1, &texture);
  std::vector<glm::vec3> pixels;
  pixels.reserve(image.texels.size());
  for (const glm::vec4& texel : image.texels) pixels.emplace_back(texel);
  write_png(path, image.width, image.height, pixels);
}

}  // namespace

std::string scene_stem(const SceneReport& report) {
  return "scenes/" + report.truth + '-' + std::to_string(report.samples);
}

SceneReport report_scene(const SceneJob& job, const std::function<bool(const reference::Progress&)>& progress) {
  Diagnostics warnings;
  const scene::Setup setup = scene::load_setup(job.scene.path, job.scene.camera, warnings);
  SceneReport report{.name = job.scene.name, .camera = job.scene.camera, .size = job.size};
  report.samples = job.settings.samples;
  report.truth = truth_id(setup, job.size, job.settings.truth);
  if (auto kept = read(file_of(job.folder, report, ".json")); kept && kept->name == report.name) return *kept;

  const Truth truth = obtain_truth(job.truth_folder, setup, job.size, job.settings.truth, progress);
  report.spp = truth.spp;
  report.seconds = truth.seconds;
  report.noise = truth.noise;
  report.without_indirect = truth.without_indirect;
  report.convergence = truth.convergence;
  fs::create_directories(fs::path(job.folder) / "scenes");
  const gpu::Context context = gpu::Context::headless();
  const auto device = gpu::CachingDevice::create({.shader_roots = job.shader_roots, .cache_dir = {}});
  report.device = device->description();
  report.aliasing = measure_aliasing(job, setup, truth, *device);
  write_picture(file_of(job.folder, report, ".png"), job, truth, setup, *device);
  write(job.folder, report);
  return report;
}

std::vector<SceneReport> read_scene_reports(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(folder) / "scenes", error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<SceneReport> reports;
  for (const fs::path& file : files) {
    if (auto report = read(file.string())) reports.push_back(std::move(*report));
  }
  return reports;
}

}  // namespace loom::measure
