// How steady the indirect light of each pipeline is at fixed points of the Cornell box while the light, or the camera,
// moves in steps of a tenth of a voxel. Flicker: the standard deviation over time of irradiance at a point, after its
// quadratic trend is removed, over its mean; printed as the root mean square over the points, a Markdown table.
//   flicker [PIPELINE]...   default: the volume pipelines
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gpu/device.h"
#include "loom/diagnostic.h"
#include "scene/load.h"
#include "scene/scene.h"
#include "support/bench.h"
#include "support/gl.h"

namespace {

using namespace loom;

constexpr int steps = 12;
constexpr int size = 64;
constexpr int points_across = 24;

/// The residual standard deviation of `values` about their least-squares parabola, over their mean.
double flicker(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  // Orthogonal polynomials on equidistant points: 1, t, t² − mean(t²).
  double mean = 0, linear = 0, quadratic = 0, tt = 0, qq = 0, t2 = 0;
  const auto at = [&](std::size_t i) { return static_cast<double>(i) - .5 * (n - 1); };
  for (std::size_t i = 0; i < values.size(); ++i) t2 += at(i) * at(i) / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = at(i), q = t * t - t2;
    mean += values[i] / n;
    linear += t * values[i];
    quadratic += q * values[i];
    tt += t * t;
    qq += q * q;
  }
  double square = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = at(i), q = t * t - t2;
    square += std::pow(values[i] - mean - linear / tt * t - quadratic / qq * q, 2) / n;
  }
  return mean > 0 ? std::sqrt(square) / mean : 0;
}

/// Irradiance at a world point as the picture shows it; nothing where the point is hidden or outside.
std::optional<double> seen_at(const test::Bench& bench, const test::Texels& depth, const test::Texels& irradiance,
                              glm::dvec3 point) {
  const glm::dvec4 clip = glm::dmat4(bench.camera().view_proj) * glm::dvec4(point, 1);
  if (clip.w <= 0) return std::nullopt;
  const glm::dvec2 at = (.5 * glm::dvec2(clip) / clip.w + .5) * static_cast<double>(size) - .5;
  const int x = static_cast<int>(std::floor(at.x)), y = static_cast<int>(std::floor(at.y));
  if (x < 0 || y < 0 || x + 1 >= size || y + 1 >= size) return std::nullopt;
  const double distance = glm::length(point - glm::dvec3(bench.camera().eye));
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const int px = x + (i & 1), py = y + (i >> 1);
    if (std::abs(depth.at(px, py).x / distance - 1) > .03) return std::nullopt;
    const glm::dvec2 f = at - glm::dvec2(x, y);
    sum += (i & 1 ? f.x : 1 - f.x) * (i >> 1 ? f.y : 1 - f.y) * irradiance.at(px, py).y;
  }
  return sum;
}

double measure(Device& device, const std::string& pipeline, glm::dvec3 light_step, glm::dvec3 camera_step) {
  Diagnostics diagnostics;
  const scene::Setup setup = scene::load_setup(LOOM_SOURCE_DIR "/configs/scenes/cornell-box.gltf", "", diagnostics);
  const scene::Camera start =
      setup.camera_index >= 0 ? setup.scene.cameras[static_cast<std::size_t>(setup.camera_index)] : setup.camera;
  std::vector<glm::dvec3> points;
  std::vector<std::vector<double>> series;
  for (int step = 0; step < steps; ++step) {
    scene::Scene moved = setup.scene;
    for (scene::Light& light : moved.lights) light.position += static_cast<double>(step) * light_step;
    scene::Camera camera = start;
    camera.eye += static_cast<double>(step) * camera_step;
    camera.target += static_cast<double>(step) * camera_step;
    test::Bench bench(device, moved);
    bench.look(camera);
    bench.render(pipeline + ".json", {.size = {size, size}, .requested = {"indirect", "gbuffer.surface.depth"}});
    const test::Texels depth = bench.read("gbuffer.surface.depth"), irradiance = bench.read("indirect");
    if (step == 0) {
      for (int i = 0; i < points_across * points_across; ++i) {
        const int x = (i % points_across) * size / points_across, y = (i / points_across) * size / points_across;
        if (depth.at(x, y).x > 0) points.push_back(bench.position(x, y, depth.at(x, y).x));
      }
      series.resize(points.size());
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const auto value = seen_at(bench, depth, irradiance, points[i])) series[i].push_back(*value);
  }
  double sum = 0;
  int count = 0;
  for (const auto& values : series) {
    if (values.size() < steps) continue;  // hidden at times
    sum += std::pow(flicker(values), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string why;
  if (!test::shared_context(why)) return std::fprintf(stderr, "%s\n", why.c_str()), 1;
  const auto device = gpu::CachingDevice::create({.shader_roots = test::source_shader_roots(), .cache_dir = "-"});
  const double voxel = 5.6 / 30;  // of the box in a grid of 32, metres
  std::vector<std::string> pipelines(argv + 1, argv + argc);
  if (pipelines.empty()) {
    pipelines = {"rsm",
                 "lpv",
                 "lpv-cascaded",
                 "lpv-surface",
                 "lpv-voxel",
                 "radiance-field",
                 "radiance-field-voxel",
                 "ray-march",
                 "ray-march-probes",
                 "cone-trace"};
  }
  std::puts("| pipeline | light moves | camera moves |\n|---|---|---|");
  for (const std::string& pipeline : pipelines) {
    const double light = measure(*device, pipeline, {.1 * voxel, 0, .05 * voxel}, {0, 0, 0});
    const double camera = measure(*device, pipeline, {0, 0, 0}, {.1 * voxel, .03 * voxel, 0});
    std::printf("| %s | %.4f | %.4f |\n", pipeline.c_str(), light, camera);
    std::fflush(stdout);
  }
  return 0;
}
