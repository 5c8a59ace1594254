// Injection: flux kept whatever the grid, the same by atomics and by points, and blockers that are shares of a face.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include <glm/vec4.hpp>

#include "volume/field.h"

namespace loom::test {
namespace {

// Injection is only a change of representation: the grid holds the flux that the maps hold.
TEST_F(LpvTest, InjectionKeepsTheFluxOfTheMaps) {
  const auto maps = test::render_text(LOOM_SOURCE_DIR "/pipelines/lpv.json", "", {32, 32},
                                      {.output = "rsm.lights.flux", .overrides = {{"rsm", "size", "64"}}});
  double emitted = 0;
  for (const glm::vec4& texel : maps.texels) emitted += texel.r;
  for (const int cells : {8, 24}) {
    const auto grid = test::render_text(
        LOOM_SOURCE_DIR "/pipelines/lpv.json", "", {32, 32},
        {.output = "inject.flux.red", .overrides = {{"rsm", "size", "64"}, {"inject", "grid", std::to_string(cells)}}});
    double injected = 0;
    for (const glm::vec4& texel : grid.texels) injected += 2 * std::sqrt(pi) * texel.x;
    EXPECT_NEAR(injected, emitted, 1e-4 * emitted) << cells;
  }
}

// Blockers are shares of a face; the floor under the light, which lies across the grid, is closed.
TEST_F(LpvTest, BlockersAreSharesOfAFaceAndALitFloorIsClosed) {
  constexpr int n = 12;
  const auto occupancy = test::render_text(
      LOOM_SOURCE_DIR "/pipelines/lpv.json", "", {256, 256},
      {.output = "inject.blockers.occupancy", .overrides = {{"rsm", "size", "128"}, {"inject", "grid", "12"}}});
  ASSERT_EQ(occupancy.texels.size(), static_cast<std::size_t>(n * n * n));
  double most = 0;
  for (const glm::vec4& texel : occupancy.texels) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(texel[axis], 0);
      EXPECT_LE(texel[axis], 1);
      most = std::max<double>(most, texel[axis]);
    }
  }
  EXPECT_GT(most, .98);
}

}  // namespace
}  // namespace loom::test
