// Voxelize against what is known of triangles: areas, planes, the two sides of a wall, and the light that they reflect.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "interop/grid.h"
#include "loom/grid.h"
#include "support/bench.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

// Reads everything, so that everything is made.
const char* const pipeline = R"({ "passes": {
    "rsm": { "type": "RSM", "params": { "shadow_size": 256 } },
    "voxelize": { "type": "Voxelize", "in": { "lights": "rsm.lights" }, "params": { "grid": 16 } } },
  "outputs": { "image": "voxelize.voxels.radiance" } })";
const char* const unlit = R"({ "passes": {
    "voxelize": { "type": "Voxelize", "params": { "grid": 16 } } },
  "outputs": { "image": "voxelize.voxels.radiance" } })";

class VoxelizeTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// The volumes of one voxelization. Slabs of a volume lie one behind the other.
struct Voxels {
  interop::Grid grid;
  Texels coverage, plane, centroid, albedo, radiance;
  [[nodiscard]] glm::ivec3 cells() const { return glm::ivec3(grid.cells); }
  [[nodiscard]] const glm::vec4& of(const Texels& volume, glm::ivec3 cell, int slab) const {
    return volume.at(cell.x, cell.y, cell.z + slab * cells().z);
  }
  /// Area of all sheets, m².
  [[nodiscard]] double area() const {
    const double face = static_cast<double>(grid.cascade[0].w) * grid.cascade[0].w;
    double sum = 0;
    for (const glm::vec4& texel : centroid.values) sum += face * texel.w / 2;  // told by both sides
    return sum;
  }
  /// Sheets of more than a thousandth of a cell face: rounding leaves slivers where a quad ends on one.
  template <class Visit>
  void each_sheet(Visit visit) const {
    for (int axis = 0; axis < 3; ++axis)
      for (int z = 0; z < cells().z; ++z)
        for (int y = 0; y < cells().y; ++y)
          for (int x = 0; x < cells().x; ++x)
            if (of(centroid, {x, y, z}, 2 * axis).w > 1e-3) visit(glm::ivec3(x, y, z), axis);
  }
};

Voxels voxelize(Bench& bench, int grid, const char* text = unlit) {
  const auto member = [](const char* name) { return std::string("voxelize.voxels.") + name; };
  BenchOptions options{.size = {8, 8}, .set = {{"voxelize", "grid", std::to_string(grid)}}};
  for (const char* name : {"coverage", "plane", "centroid", "albedo", "radiance"})
    options.requested.push_back(member(name));
  bench.render(text, options);
  return {fit_grid({bench.facts().bounds_min, bench.facts().bounds_max}, grid),
          bench.read(member("coverage")),
          bench.read(member("plane")),
          bench.read(member("centroid")),
          bench.read(member("albedo")),
          bench.read(member("radiance"))};
}

// Triangles of every shape and direction: what the cells hold together is their area, to the precision of half floats.
TEST_F(VoxelizeTest, AreasAreExactForAnyTriangle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-3, 3);
  std::uniform_real_distribution<float> little(-.05F, .05F);
  const auto somewhere = [&](auto& spread) { return glm::vec3(spread(random), spread(random), spread(random)); };
  for (const int grid : {3, 16, 33}) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(.5));
    double area = 0;
    for (int i = 0; i < 60; ++i) {
      glm::vec3 a = somewhere(place);
      glm::vec3 b = i % 3 == 0 ? a + somewhere(little) : somewhere(place);   // every third is smaller than a cell
      glm::vec3 c = i % 3 == 1   ? a + 1.001F * (b - a) + somewhere(little)  // or a needle
                    : i % 3 == 0 ? a + somewhere(little)
                                 : somewhere(place);
      scene.triangle(a, b, c, grey);
      area += .5 * glm::length(glm::cross(glm::dvec3(b - a), glm::dvec3(c - a)));
    }
    Bench bench(*device_, scene.build());
    EXPECT_NEAR(voxelize(bench, grid).area(), area, 1e-3 * area) << grid;
  }
}

// Quads on cell faces belong to one side of them, whole: nothing is lost and nothing counted twice.
TEST_F(VoxelizeTest, QuadsOnCellFacesCountOnce) {
  SceneBuilder scene;
  scene.box({-1, -1, -1}, {1, 1, 1}, scene.material(glm::vec3(.5)));
  Bench bench(*device_, scene.build());
  const Voxels v = voxelize(bench, 10);  // eight cells of .25 m, one empty at each end
  EXPECT_FLOAT_EQ(v.grid.cascade[0].w, .25F);
  EXPECT_NEAR(v.area(), 24, 1e-3);
  int sheets = 0;
  v.each_sheet([&](glm::ivec3 cell, int axis) {
    ++sheets;
    EXPECT_NEAR(v.coverage.at(cell.x, cell.y, cell.z)[axis], 1, 1e-3);
    EXPECT_NEAR(std::abs(v.of(v.plane, cell, axis)[axis]), 1, 1e-3);
    EXPECT_NEAR(std::abs(v.of(v.plane, cell, axis).w), .5, 1e-3) << "at a face of its cell";
  });
  EXPECT_EQ(sheets, 6 * 64);
}

// A plane that slants through the grid is the same plane in every cell that it crosses, and opaque in each.
TEST_F(VoxelizeTest, ASlantedPlaneIsOnePlane) {
  SceneBuilder scene;
  const glm::vec3 n = glm::normalize(glm::vec3(.3F, .9F, -.4F));
  const glm::vec3 u = glm::normalize(glm::cross(n, glm::vec3(1, 0, 0))) * 2.F, v = glm::cross(n, u);
  scene.quad(-u - v, u - v, u + v, -u + v, scene.material(glm::vec3(.5)));
  Bench bench(*device_, scene.build());
  const Voxels voxels = voxelize(bench, 20);
  const double s = voxels.grid.cascade[0].w;
  int inner = 0;
  voxels.each_sheet([&](glm::ivec3 cell, int axis) {
    ASSERT_EQ(axis, 1);
    const glm::dvec3 centre = glm::dvec3(voxels.grid.cascade[0]) + s * (glm::dvec3(cell) + .5);
    const glm::vec4 plane = voxels.of(voxels.plane, cell, axis);
    EXPECT_NEAR(glm::dot(glm::normalize(glm::vec3(plane)), n), 1, 1e-5);
    EXPECT_NEAR(glm::dot(centre, glm::dvec3(n)) + s * plane.w, 0, 2e-3 * s);
    const bool border = std::abs(glm::dot(centre, glm::dvec3(u)) / 2) > 2 - 1.8 * s ||
                        std::abs(glm::dot(centre, glm::dvec3(v)) / 2) > 2 - 1.8 * s;
    if (border) return;
    ++inner;
    EXPECT_NEAR(voxels.coverage.at(cell.x, cell.y, cell.z)[axis], 1, .02);
  });
  EXPECT_GT(inner, 50);
}

// A wall thinner than a cell, red outside on one side and green on the other: each side keeps its colour.
TEST_F(VoxelizeTest, TheTwoSidesOfAThinWallStayApart) {
  SceneBuilder scene;
  const int red = scene.material({.8F, .1F, .1F}), green = scene.material({.1F, .8F, .1F});
  const float x = .07F, thin = .02F;
  scene.quad({x, -1, 1}, {x, -1, -1}, {x, 1, -1}, {x, 1, 1}, red);                                // faces +x
  scene.quad({x - thin, -1, -1}, {x - thin, -1, 1}, {x - thin, 1, 1}, {x - thin, 1, -1}, green);  // faces −x
  Bench bench(*device_, scene.build());
  const Voxels v = voxelize(bench, 12);
  int sheets = 0;
  v.each_sheet([&](glm::ivec3 cell, int axis) {
    ++sheets;
    ASSERT_EQ(axis, 0);
    EXPECT_NEAR(v.of(v.albedo, cell, 0).r, .8, 5e-3);
    EXPECT_NEAR(v.of(v.albedo, cell, 1).g, .8, 5e-3);
    EXPECT_NEAR(v.of(v.plane, cell, 0).x, 1, 1e-3) << "two parallel surfaces are flat";
    EXPECT_EQ(v.coverage.at(cell.x, cell.y, cell.z)[0], 1);
  });
  EXPECT_GE(sheets, 100);
}

// A fence of thin bars, two a cell, covers a part of each; by OR it is a wall, by MAX a fence of every other bar.
TEST_F(VoxelizeTest, PiecesAddUpOrFillTheCellOrTheLargestCounts) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  for (int i = 0; i < 16; ++i) {
    const float x = -1 + .125F * static_cast<float>(i);
    scene.quad({x, 0, 1}, {x + .05F, 0, 1}, {x + .05F, 0, -1}, {x, 0, -1}, grey);
  }
  Bench bench(*device_, scene.build());
  for (const auto& [combine, expected] : {std::pair{"sum", .5}, {"or", 1.}, {"max", .25}}) {
    bench.render(unlit, {.size = {8, 8},
                         .set = {{"voxelize", "grid", "10"}, {"voxelize", "combine", combine}},
                         .requested = {"voxelize.voxels.coverage"}});
    const Texels coverage = bench.read("voxelize.voxels.coverage");
    double most = 0;
    for (const glm::vec4& cell : coverage.values) most = std::max<double>(most, cell.y);
    EXPECT_NEAR(most, expected, .1) << combine;
  }
}

// L = ρ/π·E on every cell of a floor under a directional light, and darkness below it.
TEST_F(VoxelizeTest, AFloorReflectsWhatItReceives) {
  const glm::vec3 albedo{.5F, .25F, .75F}, sun{3, 2, 1};
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 2, scene.material(albedo));
  scene.directional(glm::normalize(glm::vec3(.6F, -.8F, 0)), sun);
  Bench bench(*device_, scene.build());
  for (const char* text : {pipeline, unlit}) {  // by shadow map, and by rays through the voxels
    const Voxels v = voxelize(bench, 16, text);
    v.each_sheet([&](glm::ivec3 cell, int axis) {
      ASSERT_EQ(axis, 1);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(v.of(v.radiance, cell, 2)[c], albedo[c] * sun[c] * .8 / pi, 1e-3);
        EXPECT_EQ(v.of(v.radiance, cell, 3)[c], 0);
      }
    });
  }
}

// Emission arrives straight, and is reflected by the surface that it meets first.
TEST_F(VoxelizeTest, EmittersAndSkyAreReflectedOnce) {
  SceneBuilder scene;
  const glm::vec3 radiance{2, 1, .5F};
  scene.floor(glm::vec3(0), .1F, scene.material(glm::vec3(.5)));
  scene.quad({-.5F, 1, -.5F}, {.5F, 1, -.5F}, {.5F, 1, .5F}, {-.5F, 1, .5F}, scene.material(glm::vec3(0), radiance));
  Bench bench(*device_, scene.build());
  Voxels v = voxelize(bench, 34);
  double sum = 0;
  int count = 0;
  v.each_sheet([&](glm::ivec3 cell, int axis) {
    if (v.of(v.albedo, cell, 2 * axis).r < .1) return;  // the lamp
    sum += v.of(v.radiance, cell, 2 * axis).r;
    ++count;
  });
  ASSERT_GE(count, 36);
  // Under the middle of a unit square: E/(πL) = .2395, and .5 % less a tenth of a metre off it. 32 rays each.
  EXPECT_NEAR(sum / count, .5 * radiance.r * .2385, .01 * radiance.r * .2385);

  SceneBuilder open;
  open.floor(glm::vec3(0), 1, open.material(glm::vec3(.5)));
  open.sky(radiance);
  Bench under_sky(*device_, open.build());
  v = voxelize(under_sky, 8);
  v.each_sheet([&](glm::ivec3 cell, int axis) {
    for (const int side : {0, 1})
      EXPECT_NEAR(v.of(v.radiance, cell, 2 * axis + side).r, .5F * radiance.r, 1e-3 * radiance.r);
  });
}

TEST_F(VoxelizeTest, AMaskThatCutsEverythingLeavesNothing) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(.5)));
  const int leaf = scene.material(glm::vec3(.5));
  scene.floor(glm::vec3(0, 1, 0), 1, leaf);
  scene::Scene made = scene.build();
  made.materials[static_cast<std::size_t>(leaf)].alpha = scene::AlphaMode::mask;
  made.materials[static_cast<std::size_t>(leaf)].alpha_cutoff = .5F;
  made.materials[static_cast<std::size_t>(leaf)].base_color.a = .25F;
  Bench bench(*device_, made);
  EXPECT_NEAR(voxelize(bench, 8).area(), 4, 1e-2);
}

TEST_F(VoxelizeTest, TheSameFrameTwiceIsTheSame) {
  SceneBuilder scene;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-1, 1);
  const auto point = [&] { return glm::vec3(place(random), place(random), place(random)); };
  const int grey = scene.material({.5F, .4F, .3F});
  for (int i = 0; i < 40; ++i) scene.triangle(point(), point(), point(), grey);
  scene.point({0, 2, 0}, {10, 10, 10});
  Bench bench(*device_, scene.build());
  const Voxels first = voxelize(bench, 16, pipeline);
  const Voxels second = voxelize(bench, 16, pipeline);
  EXPECT_EQ(first.coverage, second.coverage);
  EXPECT_EQ(first.plane, second.plane);
  EXPECT_EQ(first.radiance, second.radiance);
}

}  // namespace
}  // namespace loom::test
