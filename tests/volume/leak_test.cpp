// How much light passes a wall that fills the grid, by the wall's thickness: face blockers and those by direction.
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec3.hpp>

#include "support/bench.h"
#include "volume/field.h"

namespace loom::test {
namespace {

/// Two rooms of together 6 m, so that 8 cells are of 1 m, with a wall between them and a light in each. The light of
/// the second is of no account: it shows the wall's other face to the blockers.
scene::Scene two_rooms(float from, float thickness) {
  SceneBuilder scene;
  const int grey = scene.material(glm::vec3(.5F));
  scene.box(glm::vec3(-3), glm::vec3(3), grey);
  scene.box({from, -3, -3}, {from + thickness, 3, 3}, grey);
  return scene.point({-1.7F, .2F, .3F}, glm::vec3(5)).point({2.7F, .2F, .3F}, glm::vec3(1e-6F)).build();
}

class Leak : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  /// Share of all light in the cells that lie wholly behind the wall.
  double behind(float from, float thickness, const std::string& blockers) {
    Bench bench(*device_, two_rooms(from, thickness));
    const Texels red = bench.image(R"({ "passes": {
        "rsm": { "type": "RSM", "params": { "size": 128, "shadow_size": 16 } },
        "inject": { "type": "Inject", "in": { "lights": "rsm.lights" }, "params": { "grid": 8 } },
        "lpv": { "type": "LPV", "in": { "flux": "inject.flux", "blockers": "inject.blockers" },
                 "params": { "iterations": 64, "bounces": 4, "blockers": ")" +
                                       blockers + R"(" } } },
      "outputs": { "image": "lpv.intensity.red" } })",
                                   "image", {.size = {8, 8}});
    double sum = 0, back = 0;
    for (int z = 0; z < 8; ++z)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const double flux = red.at(x, y, z).x;
          sum += flux;
          if (static_cast<float>(x - 4) >= from + thickness) back += flux;
        }
    return back / sum;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

// Where the wall's face lies in its cell makes no difference to the cell that its light starts from and the face that
// blocks: less than 1 % passes, all of it at the wall's edges, where lights see the last row of faces at a slant. By
// direction, two bands let through a quarter of what meets a face head-on, and half where both faces share a corner.
TEST_F(Leak, ByThicknessOfTheWallInVoxels) {
  struct Row {
    float thickness;
    double least_sh, most_sh;
  };
  for (const Row& row : {Row{.1F, .04, .2}, Row{.5F, .015, .1}, Row{1.F, .015, .03}, Row{2.F, .005, .01}}) {
    for (const float from : {-.45F, -.2F, 0.F}) {
      const double faces = behind(from, row.thickness, "faces"), sh = behind(from, row.thickness, "sh");
      EXPECT_LT(faces, .01) << row.thickness << " m at " << from;
      EXPECT_GT(sh, row.least_sh) << row.thickness << " m at " << from;
      EXPECT_LT(sh, row.most_sh) << row.thickness << " m at " << from;
    }
  }
}

}  // namespace
}  // namespace loom::test
