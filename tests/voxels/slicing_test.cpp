// The ways of cutting triangles into cells, and of making one occupancy of the pieces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <random>
#include <string>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "loom/grid.h"
#include "support/bench.h"

namespace loom::test {
namespace {

const char* const pipeline = R"({ "passes": { "voxelize": { "type": "Voxelize" } },
                                  "outputs": { "image": "voxelize.voxels.coverage" } })";

class SlicingTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

struct Sheets {
  Texels coverage, centroid;
  double face = 0;  ///< m²
  [[nodiscard]] double area() const {
    double sum = 0;
    for (const glm::vec4& texel : centroid.values) sum += face * static_cast<double>(texel.w) / 2;
    return sum;
  }
  [[nodiscard]] float most_covered(int axis) const {
    float most = 0;
    for (const glm::vec4& cell : coverage.values) most = std::max(most, cell[axis]);
    return most;
  }
};

Sheets sheets(Bench& bench, int grid, const std::string& slicing, const std::string& combine = "sum") {
  bench.render(pipeline, {.size = {8, 8},
                          .set = {{"voxelize", "grid", std::to_string(grid)},
                                  {"voxelize", "slicing", slicing},
                                  {"voxelize", "combine", combine}},
                          .requested = {"voxelize.voxels.coverage", "voxelize.voxels.centroid"}});
  const double cell =
      static_cast<double>(fit_grid({bench.facts().bounds_min, bench.facts().bounds_max}, grid).cascade[0].w);
  return {bench.read("voxelize.voxels.coverage"), bench.read("voxelize.voxels.centroid"), cell * cell};
}

// Whether the fragment looks for its slice or the triangle was cut to it before: the same fragments, in the same cells.
TEST_F(SlicingTest, FragmentAndGeometryClippingAgree) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-1, 1);
  const auto point = [&] { return glm::vec3(place(random), place(random), place(random)); };
  SceneBuilder scene;
  double area = 0;
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 a = point(), b = point(), c = point();
    scene.triangle(a, b, c, scene.material(glm::vec3(.5)));
    area += .5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
  }
  Bench bench(*device_, scene.build());
  for (const int grid : {3, 33, 65}) {
    const Sheets fragment = sheets(bench, grid, "fragment");
    const Sheets geometry = sheets(bench, grid, "geometry");
    std::size_t apart = 0;
    std::size_t occupied = 0;
    for (std::size_t i = 0; i < fragment.coverage.values.size(); ++i) {
      apart += fragment.coverage.values[i] != geometry.coverage.values[i] ? 1 : 0;
      occupied += fragment.coverage.values[i].w > 0 ? 1 : 0;
    }
    // Rasterisers place corners on a raster of 1/256 pixel: so near to a slice's end the two may differ.
    EXPECT_LE(apart, .01 * static_cast<double>(occupied)) << grid;
    EXPECT_NEAR(geometry.area(), fragment.area(), 1e-3 * area) << grid;
    // Each fragment stands for its column: right on the mean, and the better the more columns a triangle covers.
    if (grid > 3) {
      EXPECT_NEAR(fragment.area(), area, .02 * area) << grid;
    }
  }
}

// What covers no column's middle is in no fragment, however many such triangles there are; cut exactly it is there.
TEST_F(SlicingTest, OnlyExactCuttingSeesWhatFallsBetweenSamples) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  scene.triangle({0, 0, 0}, {0, 0, 0}, {4, 0, 4}, grey);  // no area: the grid's extent alone
  double area = 0;
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 corner(static_cast<float>(i) + .05F, 0, static_cast<float>(i) + .05F);  // cells of 1 m
    scene.triangle(corner, corner + glm::vec3(0, 0, .3F), corner + glm::vec3(.3F, 0, 0), grey);
    area += .045;
  }
  Bench bench(*device_, scene.build());
  EXPECT_NEAR(sheets(bench, 6, "area").area(), area, 1e-3 * area);
  EXPECT_EQ(sheets(bench, 6, "fragment").area(), 0);
  EXPECT_EQ(sheets(bench, 6, "geometry").area(), 0);
}

// A floor of 32 triangles a cell. OR and MAX of fragments, each of which stands for its column, are full; so is the sum
// of exact areas, of which the largest is a 32nd.
TEST_F(SlicingTest, TheLargestPieceIsTheWholeOnlyWhereFragmentsStandForColumns) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5));
  const float step = .25F;  // cells of 1 m
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j) {
      const glm::vec3 corner(step * static_cast<float>(i), 0, step * static_cast<float>(j));
      scene.quad(corner, corner + glm::vec3(0, 0, step), corner + glm::vec3(step, 0, step),
                 corner + glm::vec3(step, 0, 0), grey);
    }
  Bench bench(*device_, scene.build());
  EXPECT_NEAR(sheets(bench, 6, "area", "sum").most_covered(1), 1, 1e-3);
  EXPECT_NEAR(sheets(bench, 6, "area", "max").most_covered(1), 1. / 32, 1e-3);
  EXPECT_NEAR(sheets(bench, 6, "area", "or").most_covered(1), 1, 1e-3);
  for (const char* slicing : {"fragment", "geometry"}) {
    for (const char* combine : {"sum", "or", "max"})
      EXPECT_NEAR(sheets(bench, 6, slicing, combine).most_covered(1), 1, 1e-3) << slicing << ' ' << combine;
  }
}

}  // namespace
}  // namespace loom::test
