// Still and moving surfaces voxelized apart: what they give together, what is drawn again, what is allocated.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/grid.h"
#include "support/bench.h"

namespace loom::test {
namespace {

const char* const pipeline = R"({ "passes": {
    "voxelize": { "type": "Voxelize", "params": { "grid": 16, "rays": 4 } } },
  "outputs": { "image": "voxelize.voxels.radiance" } })";
const std::vector<std::string> volumes{"voxelize.voxels.coverage", "voxelize.voxels.plane",  "voxelize.voxels.extent",
                                       "voxelize.voxels.centroid", "voxelize.voxels.albedo", "voxelize.voxels.emission",
                                       "voxelize.voxels.radiance"};

/// A room with sixty triangles in it, and a lamp of twelve triangles that flies through them into a wall.
SceneBuilder room() {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-1, 1);
  const auto point = [&] { return glm::vec3(place(random), place(random), place(random)); };
  SceneBuilder scene;
  const int grey = scene.material({.5F, .4F, .3F});
  scene.box({-1, -1, -1}, {1, 1, 1}, grey);
  for (int i = 0; i < 60; ++i) scene.triangle(point(), point(), point(), grey);
  scene.point({0, .9F, 0}, {1, 2, 3});
  return scene;
}
scene::Scene room_with_flying_lamp() {
  SceneBuilder scene = room();
  scene.moving({1.2F, .3F, .1F});
  scene.box({-.7F, -.2F, -.2F}, {-.4F, .1F, .1F}, scene.material({.9F, .1F, .1F}, {2, 1, 0}));
  return scene.build();
}
constexpr std::size_t still_triangles = 72;
constexpr std::size_t moving_triangles = 12;

class MovingTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  /// Triangles that the geometry stage let through in one more frame; two for each that it is given.
  static std::size_t drawn(Bench& bench) {
    GLuint query = 0;
    GLuint primitives = 0;
    glCreateQueries(GL_PRIMITIVES_GENERATED, 1, &query);
    glBeginQuery(GL_PRIMITIVES_GENERATED, query);
    bench.next_frame();
    glEndQuery(GL_PRIMITIVES_GENERATED);
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &primitives);
    glDeleteQueries(1, &query);
    return primitives / 2;
  }
  static bool has(const Bench& bench, const std::string& name) {
    const auto& resources = bench.renderer().graph().resources;
    return std::any_of(resources.begin(), resources.end(),
                       [&](const auto& r) { return r.name.find(name) != std::string::npos; });
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

TEST_F(MovingTest, TheSumOfBothIsWhatVoxelizingEverythingGives) {
  Bench apart(*device_, room_with_flying_lamp());
  Bench whole(*device_, room_with_flying_lamp());
  BenchOptions options{.size = {8, 8}, .requested = volumes};
  apart.render(pipeline, options);
  options.prune = false;  // everything anew in every frame
  whole.render(pipeline, options);
  const auto before = apart.read("voxelize.voxels.coverage");
  for (const double time : {.3, .7, 5.}) {
    for (Bench* bench : {&apart, &whole}) {
      bench->pose(time);
      bench->next_frame();
    }
    for (const std::string& volume : volumes)
      EXPECT_EQ(apart.read(volume), whole.read(volume)) << volume << ' ' << time;
  }
  EXPECT_NE(apart.read("voxelize.voxels.coverage"), before);
}

TEST_F(MovingTest, OnlyWhatMovesIsDrawnAgain) {
  Bench bench(*device_, room_with_flying_lamp());
  bench.render(pipeline, {.size = {8, 8}, .requested = {"voxelize.voxels.coverage"}, .frames = 0});
  EXPECT_EQ(drawn(bench), still_triangles + moving_triangles);
  bench.pose(.5);
  EXPECT_EQ(drawn(bench), moving_triangles);
  bench.reset();
  EXPECT_EQ(drawn(bench), still_triangles + moving_triangles) << "a reset forgets the sums";
}

// Where nothing moves there is nothing to keep; where only a light does, there is nothing to add to what is kept.
TEST_F(MovingTest, WhatTheSceneDoesNotNeedIsNotAllocated) {
  const auto resources = [&](scene::Scene scene) {
    Bench bench(*device_, std::move(scene));
    bench.render(pipeline, {.size = {8, 8}, .requested = {"voxelize.voxels.coverage"}, .frames = 0});
    return std::pair(has(bench, "still"), has(bench, "sums"));
  };
  EXPECT_EQ(resources(room().build()), std::pair(false, true));
  EXPECT_EQ(resources(room_with_flying_lamp()), std::pair(true, true));
  SceneBuilder light = room();
  light.moving({1, 0, 0});
  scene::Scene scene = light.build();
  scene.animations.front().channels.push_back({.node = static_cast<int>(scene.nodes.size()),
                                               .times = {0, 1},
                                               .values = {glm::vec4(0, .9F, 0, 0), glm::vec4(.5F, .9F, 0, 0)}});
  scene.nodes.push_back({.translation = {0, .9, 0}, .light = 0});
  EXPECT_EQ(resources(scene), std::pair(true, false));
  Bench bench(*device_, scene);
  bench.render(pipeline, {.size = {8, 8}, .requested = {"voxelize.voxels.radiance"}});
  const Texels before = bench.read("voxelize.voxels.radiance");
  bench.pose(1);
  EXPECT_EQ(drawn(bench), 0U);
  EXPECT_NE(bench.read("voxelize.voxels.radiance"), before) << "lit anew";
}

// The lamp leaves the box that it starts in: the grid holds its whole path from the first frame on.
TEST_F(MovingTest, TheGridHoldsTheWholePath) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), .25F, scene.material(glm::vec3(.5)));
  scene.moving({3, 2, 0});
  scene.floor(glm::vec3(0, .5F, 0), .25F, scene.material(glm::vec3(.5)));
  Bench bench(*device_, scene.build());
  const interop::Grid grid = fit_grid({bench.facts().bounds_min, bench.facts().bounds_max}, 16);
  bench.render(pipeline, {.size = {8, 8}, .requested = {"voxelize.voxels.centroid"}});
  for (const double time : {0., .4, 1.}) {
    bench.pose(time);
    bench.next_frame();
    double area = 0;
    for (const glm::vec4& texel : bench.read("voxelize.voxels.centroid").values) area += texel.w / 2;
    const double face = static_cast<double>(grid.cascade[0].w) * grid.cascade[0].w;
    EXPECT_NEAR(face * area, .5, 1e-3) << time;
  }
}

}  // namespace
}  // namespace loom::test
