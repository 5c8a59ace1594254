// How steady the indirect light of each pipeline is at fixed points of the Cornell box while the light, or the camera,
// moves in steps of a tenth of a voxel. Flicker: the standard deviation over time of irradiance at a point, after its
// quadratic trend is removed, over its mean; printed as the root mean square over the points, a Markdown table.
//   flicker [PIPELINE]...   default: the volume pipelines
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "measure/flicker.h"
#include "scene/load.h"
#include "scene/scene.h"
#include "support/bench.h"
#include "volume_pipelines.h"

namespace {

using namespace loom;

constexpr int steps = 12;
constexpr int size = 64;

double flicker_of(Device& device, const std::string& pipeline, glm::dvec3 light_step, glm::dvec3 camera_step) {
  Diagnostics diagnostics;
  const scene::Setup setup = scene::load_setup(LOOM_SOURCE_DIR "/configs/scenes/cornell-box.gltf", "", diagnostics);
  const scene::Camera start =
      setup.camera_index >= 0 ? setup.scene.cameras[static_cast<std::size_t>(setup.camera_index)] : setup.camera;
  measure::FlickerProbe probe;
  for (int step = 0; step < steps; ++step) {
    scene::Scene moved = setup.scene;
    for (scene::Light& light : moved.lights) light.position += static_cast<double>(step) * light_step;
    scene::Camera camera = start;
    camera.eye += static_cast<double>(step) * camera_step;
    camera.target += static_cast<double>(step) * camera_step;
    test::Bench bench(device, moved);
    bench.look(camera);
    bench.render(pipeline + ".json", {.size = {size, size}, .requested = {"indirect", "gbuffer.surface.depth"}});
    probe.add(bench.camera(), bench.renderer().read("gbuffer.surface.depth"), bench.renderer().read("indirect"));
  }
  return probe.value();
}

}  // namespace

int main(int argc, char** argv) {
  const auto device = test::table_device();
  if (!device) return 1;
  const double voxel = 5.6 / 30;  // of the box in a grid of 32, metres
  std::puts("| pipeline | light moves | camera moves |\n|---|---|---|");
  for (const std::string& pipeline : test::volume_pipelines(argc, argv)) {
    const double light = flicker_of(*device, pipeline, {.1 * voxel, 0, .05 * voxel}, {0, 0, 0});
    const double camera = flicker_of(*device, pipeline, {0, 0, 0}, {.1 * voxel, .03 * voxel, 0});
    std::printf("| %s | %.4f | %.4f |\n", pipeline.c_str(), light, camera);
    std::fflush(stdout);
  }
  return 0;
}
