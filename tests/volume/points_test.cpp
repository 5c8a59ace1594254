// Injection from points of the surface itself, from further views and from cubemaps: areas are those of the surface,
// flux is that of the lights, and what no light and no camera sees blocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/diagnostic.h"
#include "support/bench.h"
#include "support/gl.h"

namespace loom::test {
namespace {

using Set = std::vector<graph::Override>;

/// Points into Inject, by whichever input; `lit`: they bring the flux too.
std::string points_pipeline(const std::string& input, bool lit, const std::string& more = "") {
  const std::string lights = lit ? R"("in": { "lights": "rsm.lights" },)" : "";
  return R"({ "passes": {
      "rsm": { "type": "RSM", "params": { "size": 128, "shadow_size": 512 } },
      "points": { "type": "SurfacePoints", )" +
         lights + R"( "params": { "size": 128 } },
      "inject": { "type": "Inject", "in": { ")" +
         input + R"(": "points.points")" + more + R"( }, "params": { "grid": 8, "emission_rays": 64 } } },
    "outputs": { "image": "inject.blockers.occupancy", "flux": "inject.flux.red" } })";
}

class InjectedPoints : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels read(Bench& bench, const std::string& pipeline, const std::string& output, Set set = {}) {
    return bench.image(pipeline, output, {.size = {16, 16}, .set = std::move(set)});
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

glm::dvec4 sum_of(const Texels& texels) {
  glm::dvec4 sum(0);
  for (const glm::vec4& texel : texels.values) sum += glm::dvec4(texel);
  return sum;
}

const glm::dvec3 slope = glm::normalize(glm::dvec3(1, 2, 3));

/// A square of 4 m² with that normal, in pieces, under a sky, so that there is something to inject.
scene::Scene slanted_square(int pieces) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  const glm::dvec3 u = glm::normalize(glm::cross(slope, glm::dvec3(0, 1, 0))), v = glm::cross(slope, u);
  const auto at = [&](int x, int y) { return glm::vec3((2. * x / pieces - 1) * u + (2. * y / pieces - 1) * v); };
  for (int y = 0; y < pieces; ++y) {
    for (int x = 0; x < pieces; ++x) scene.quad(at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1), grey);
  }
  return scene.sky(glm::vec3(1)).build();
}

// By every way of finding points: their areas add up to that of the square, and the faces that they block to its
// projections, A·|⟨n,e⟩|.
TEST_F(InjectedPoints, HaveTheAreaOfTheSurface) {
  Bench bench(*device_, slanted_square(24));
  const glm::dvec3 extent = bench.facts().bounds_max - bench.facts().bounds_min;
  const double cell = std::max({extent.x, extent.y, extent.z}) / 6;
  struct Way {
    const char *from, *input, *size;
    int seen;          // how often the square is
    double tolerance;  // of its area
  };
  // Of the six sides the one that sees most of a face counts, which is a little too much: they need more texels.
  for (const Way& way : {Way{"area", "samples", "128", 1, 1e-5}, Way{"vertices", "samples", "128", 1, 1e-5},
                         Way{"sides", "views", "256", 6, .01}, Way{"cube", "environment", "128", 1, .01}}) {
    const Set set{{"points", "from", way.from},
                  {"points", "size", way.size},
                  {"points", "x", "1"},
                  {"points", "y", "1"},
                  {"points", "z", "1"}};
    const std::string pipeline = points_pipeline(way.input, false);
    const double area = 4. * way.seen;
    EXPECT_NEAR(sum_of(read(bench, pipeline, "points.points.position", set)).w, area, area * way.tolerance) << way.from;
    const glm::dvec4 blocked = sum_of(read(bench, pipeline, "image", set)) * cell * cell;
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(blocked[axis] / (4 * slope[axis]), 1, .015) << way.from << axis;
  }
}

TEST_F(InjectedPoints, BlockTheSameWhateverTheirNumber) {
  Bench bench(*device_, slanted_square(1));
  const std::string pipeline = points_pipeline("samples", false);
  const auto blocked = [&](const char* size) {
    return sum_of(read(bench, pipeline, "image", {{"points", "size", size}}));
  };
  const glm::dvec4 truth = blocked("512");
  for (const char* size : {"64", "128", "256"}) {
    const glm::dvec4 sum = blocked(size);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis] / truth[axis], 1, .01) << size << axis;
  }
}

/// A closed room of 6 m with a block in it and a light at a quarter of the way along each axis.
scene::Scene lit_room() {
  SceneBuilder scene;
  scene.box(glm::vec3(-3), glm::vec3(3), scene.material({.5F, .4F, .3F}));
  scene.box({.5F, -3, 0}, {2, .5F, 1.5F}, scene.material({.8F, .2F, .6F}));
  return scene.point(glm::vec3(-1.5F), glm::vec3(5)).build();
}

// What points reflect is what the light's map says, and Inject keeps it, by either way of adding up.
TEST_F(InjectedPoints, ReflectWhatTheLightsSend) {
  Bench bench(*device_, lit_room());
  const std::string pipeline = points_pipeline("samples", true);
  const double reflected = sum_of(read(bench, pipeline, "rsm.lights.flux")).x;
  for (const char* from : {"area", "cube"}) {
    for (const char* size : {"64", "128", "256"}) {
      const Set set{{"points", "from", from},
                    {"points", "size", size},
                    {"points", "x", ".25"},
                    {"points", "y", ".25"},
                    {"points", "z", ".25"}};
      const double flux = sum_of(read(bench, pipeline, "points.points.flux", set)).x;
      EXPECT_NEAR(flux / reflected, 1, .01) << from << size;
    }
  }
  const Set set{{"points", "size", "64"}};
  const double flux = sum_of(read(bench, pipeline, "points.points.flux", set)).x;
  const Texels atomics = read(bench, pipeline, "flux", set);
  EXPECT_NEAR(2 * std::sqrt(std::acos(-1.)) * sum_of(atomics).x / flux, 1, 1e-4);
  const Texels points = read(bench, pipeline, "flux", {{"points", "size", "64"}, {"inject", "method", "points"}});
  for (std::size_t i = 0; i < atomics.values.size(); ++i) {
    EXPECT_NEAR(atomics.values[i].x, points.values[i].x, 1e-5 * flux) << i;
  }
}

// Two walls, the light before the first: the second is in its shadow, and it has holes for no camera.
TEST_F(InjectedPoints, OfWhatNoLightSeesBlock) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  for (const float z : {0.F, -3.4F}) scene.quad({-3, -3, z}, {3, -3, z}, {3, 3, z}, {-3, 3, z}, grey);
  Bench bench(*device_, scene.point({0, 0, 2}, glm::vec3(5)).build());
  const auto least = [&](const std::string& pipeline, int layer, const Set& set = {}) {
    const Texels occupancy = read(bench, pipeline, "image", set);
    float smallest = 1;
    for (int y = 1; y < 7; ++y)
      for (int x = 1; x < 7; ++x) smallest = std::min(smallest, occupancy.at(x, y, layer).z);
    return smallest;
  };
  const std::string lights = R"(, "lights": "rsm.lights")";
  // Cells of 1 m from z = −5.7 on: the walls stand at 2.3 and 5.7, nearest to faces 2 and 6.
  const std::string without = points_pipeline("samples", false, lights);
  const std::string only_lights = [&] {
    std::string text = without;
    return text.replace(text.find(R"("samples": "points.points", )"), 28, "");
  }();
  EXPECT_GT(least(only_lights, 6), .9F);
  EXPECT_EQ(least(only_lights, 2), 0);
  EXPECT_GT(least(without, 6), .9F);
  EXPECT_GT(least(without, 2), .9F);
  EXPECT_GT(least(points_pipeline("views", false, lights), 2, {{"points", "from", "sides"}}), .9F);
  EXPECT_GT(least(points_pipeline("environment", false, lights), 2, {{"points", "from", "cube"}}), .9F);
}

TEST_F(InjectedPoints, OutliveAMoveOfTheCamera) {
  Bench bench(*device_, lit_room());
  const auto kept = [&](const char* pipeline) {
    bench.look({-1, 0, -2}, {2, -1, 2}, .5);
    bench.render(pipeline, {.size = {16, 16}});
    bench.look({-2, 1, -2}, {2, -1, 2}, .5);
    bench.next_frame();
    const auto passes = bench.renderer().kept_passes();
    return std::count(passes.begin(), passes.end(), "inject") + std::count(passes.begin(), passes.end(), "lpv");
  };
  EXPECT_EQ(kept("lpv-surface.json"), 2);
  EXPECT_EQ(kept("lpv.json"), 0);
}

TEST_F(InjectedPoints, BringNoLightTwice) {
  Bench bench(*device_, lit_room());
  try {
    bench.render(points_pipeline("samples", true, R"(, "lights": "rsm.lights")"), {.size = {16, 16}});
    FAIL() << "rendered";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("counted-twice"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace loom::test
