// How much light each pipeline lets through a wall: two rooms with a light in one, and the mean indirect irradiance of
// the other as a share of that of the lit one, by the wall's thickness in voxels. Of a wall flush with the grid and one
// .37 cells off it the worse; a Markdown table.
//   leaks [PIPELINE]...   default: the volume pipelines
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "graph/compile/compile.h"
#include "scene/scene.h"
#include "support/bench.h"
#include "support/scene_builders.h"
#include "volume_pipelines.h"

namespace {

using namespace loom;

constexpr int grid = 18;  // 16 voxels along both rooms, and one at each end
constexpr float length = 4;
constexpr float voxel = length / (grid - 2);

scene::Scene two_rooms(float from, float thickness) {
  scene::Scene scene;
  scene.materials = {test::diffuse(glm::vec3(.7F))};
  test::add_box(scene, {-.5F * length, -1, -1}, {.5F * length, 1, 1}, 0, true);
  test::add_box(scene, {from, -1, -1}, {from + thickness, 1, 1}, 0);
  test::add_point_light(scene, {-1, .2F, .1F}, glm::vec3(5));
  test::finish(scene);
  return scene;
}

/// The same voxels for all that have any.
std::vector<graph::Override> set_of(const std::string& pipeline) {
  if (pipeline.rfind("lpv", 0) == 0 && pipeline.find("voxel") == std::string::npos)
    return {{"inject", "grid", std::to_string(grid)}};
  if (pipeline == "rsm" || pipeline == "radiance-field") return {};
  return {{"voxelize", "grid", std::to_string(grid)}};
}

double leak(Device& device, const std::string& pipeline, float thickness) {
  double worst = 0;
  for (const float shift : {0.F, .37F}) {
    test::Bench bench(device, two_rooms(shift * voxel, thickness * voxel));
    const auto mean = [&](glm::dvec3 eye, glm::dvec3 target) {
      bench.look(eye, target, .6);
      return static_cast<double>(
          bench.image(pipeline + ".json", "indirect", {.size = {24, 24}, .set = set_of(pipeline)}).mean().y);
    };
    const double lit = mean({-.5, .3, 0}, {-2, -.8, .3});
    worst = std::max(worst, mean({1, .3, 0}, {2, -.8, .3}) / lit);
  }
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  const auto device = test::table_device();
  if (!device) return 1;
  std::puts("| pipeline | .1 | .25 | .5 | 1 | 2 |\n|---|---|---|---|---|---|");
  for (const std::string& pipeline : test::volume_pipelines(argc, argv)) {
    std::printf("| %s", pipeline.c_str());
    for (const float thickness : {.1F, .25F, .5F, 1.F, 2.F}) {
      std::printf(" | %.4f", leak(*device, pipeline, thickness));
      std::fflush(stdout);
    }
    std::puts(" |");
  }
  return 0;
}
