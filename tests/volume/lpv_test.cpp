// Light propagation in grids whose answers are known: flux kept, walls that leak nothing, a geometric series of
// bounces.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/camera.h"
#include "interop/grid.h"
#include "loom/diagnostic.h"
#include "loom/pass.h"
#include "plugins/loader.h"
#include "support/render.h"

namespace loom {
namespace {

using test::add_pass;
using test::PassFunctions;
using test::RenderTest;

constexpr double pi = std::numbers::pi;

/// SH coefficients (c00, c1−1, c10, c11) of the lobe Φ/π·⟨n,ω⟩₊ of flux 1 W.
glm::vec4 unit_lobe(glm::vec3 n) {
  constexpr float z0 = .88622693F, z1 = 1.02332671F;
  return glm::vec4(z0, z1 * n.y, z1 * n.z, z1 * n.x) / static_cast<float>(pi);
}

/// What the fake sources put into the grid.
struct Field {
  int n = 16;
  std::vector<glm::vec4> red;        // coefficients, x fastest
  std::vector<glm::vec4> occupancy;  // of the three lower faces
  std::vector<glm::vec4> albedo;     // 3 slabs
  explicit Field(int cells)
      : n(cells),
        red(static_cast<std::size_t>(cells * cells * cells)),
        occupancy(red.size()),
        albedo(3 * red.size(), glm::vec4(.5F)) {}
  [[nodiscard]] std::size_t at(int x, int y, int z) const { return static_cast<std::size_t>(x + n * (y + n * z)); }
};

class LpvTest : public RenderTest {
 protected:
  void SetUp() override {
    RenderTest::SetUp();
    if (IsSkipped()) return;
    Diagnostics diagnostics;
    plugins::load_plugins({.dirs = {LOOM_BINARY_DIR "/lib/loom/passes"}, .installed = false}, registry_, diagnostics);
    ASSERT_FALSE(diagnostics.has_errors());
  }

  /// Registers `Source` (flux and blockers of `field`) for this test.
  void add_source(const Field& field) {
    add_pass(registry_, "Source", [&field] {
      return PassFunctions{
          .reflect =
              [&field](Ports& ports) {
                auto flux = ports.out("flux", "ShVolume");
                for (const char* channel : {"red", "green", "blue"}) {
                  flux.texture(channel, TextureDesc::volume(field.n, Format::rgba32f), Access::image_write);
                }
                auto blockers = ports.out("blockers", "VoxelScene");
                TextureDesc volume = TextureDesc::volume(field.n, Format::rgba32f, Filter::nearest);
                blockers.texture("occupancy", volume, Access::image_write);
                volume.depth *= 3;
                blockers.texture("albedo", volume, Access::image_write);
              },
          .execute =
              [&field](Frame&, const Bindings& io) {
                interop::Grid grid{};
                grid.cells = {field.n, field.n, field.n, 1};
                grid.cascade[0] = {0, 0, 0, 1};
                io.publish("flux", grid);
                for (const char* channel : {"red", "green", "blue"}) {
                  io.texture("flux." + std::string(channel)).write(std::as_bytes(std::span(field.red)));
                }
                if (!io.has("blockers.occupancy")) return;
                io.publish("blockers", grid);
                io.texture("blockers.occupancy").write(std::as_bytes(std::span(field.occupancy)));
                io.texture("blockers.albedo").write(std::as_bytes(std::span(field.albedo)));
              }};
    });
  }

  /// Coefficients of the red channel after propagation.
  std::vector<glm::vec4> propagate(bool blockers, int iterations, int bounces = 1) {
    const std::string pipeline = R"({"passes": {
      "source": {"type": "Source"},
      "lpv": {"type": "LPV", "in": {"flux": "source.flux")" +
                                 std::string(blockers ? R"(, "blockers": "source.blockers")" : "") +
                                 R"(}, "params": {"iterations": )" + std::to_string(iterations) + R"(, "bounces": )" +
                                 std::to_string(bounces) + R"(}}},
      "outputs": {"image": "lpv.intensity.red"}})";
    const auto renderer = make(pipeline);
    frame(*renderer);
    return renderer->output("image")->read();
  }

  /// Flux of the cells for which `keep` holds: ∫ I dω = 2√π·c00.
  template <class Keep>
  static double flux(const Field& field, const std::vector<glm::vec4>& cells, Keep keep) {
    double sum = 0;
    for (int z = 0; z < field.n; ++z)
      for (int y = 0; y < field.n; ++y)
        for (int x = 0; x < field.n; ++x)
          if (keep(x, y, z)) sum += 2 * std::sqrt(pi) * cells[field.at(x, y, z)].x;
    return sum;
  }
  static double total(const Field& field, const std::vector<glm::vec4>& cells) {
    return flux(field, cells, [](int, int, int) { return true; });
  }
};

// As long as nothing reaches the border, every step carries the whole flux: after n steps the sum is (n+1)·Φ. A clamp
// without rescaling would gain 13.8 % in the first step.
TEST_F(LpvTest, KeepsTheFluxOfALobe) {
  Field field(16);
  field.red[field.at(8, 8, 8)] = unit_lobe(glm::normalize(glm::vec3(.3F, -.5F, .8F)));
  add_source(field);
  for (const int iterations : {0, 1, 2, 7}) {
    EXPECT_NEAR(total(field, propagate(false, iterations)), iterations + 1, 1e-4 * (iterations + 1)) << iterations;
  }
}

TEST_F(LpvTest, FluxOnlyLeavesOverTheBorder) {
  Field field(8);
  field.red[field.at(4, 4, 4)] = unit_lobe({0, 1, 0});
  add_source(field);
  double sum = total(field, propagate(false, 0)), under_way = 1 + 1e-4;
  for (int iterations = 1; iterations <= 24; ++iterations) {
    const double next = total(field, propagate(false, iterations));
    EXPECT_GE(next, sum);
    EXPECT_LE(next - sum, under_way) << iterations;  // what is on its way never grows
    under_way = (next - sum) * (1 + 1e-4);
    sum = next;
  }
  EXPECT_LT(under_way, .5);  // most has left: the border is four steps away
}

TEST_F(LpvTest, AFullWallLeaksNothing) {
  Field field(12);
  field.red[field.at(3, 6, 6)] = unit_lobe({1, 0, 0});
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 12; ++y) field.occupancy[field.at(6, y, z)].x = 1;
  add_source(field);
  const auto cells = propagate(true, 64, 4);
  EXPECT_EQ(flux(field, cells, [](int x, int, int) { return x >= 6; }), 0);
  EXPECT_GT(flux(field, cells, [](int x, int, int) { return x < 6; }), 1);
}

TEST_F(LpvTest, AHalfOpenWallLetsHalfThrough) {
  Field field(12);
  field.red[field.at(5, 6, 6)] = unit_lobe({1, 0, 0});
  add_source(field);
  const auto right = [](int x, int, int) { return x >= 6; };
  const double open = flux(field, propagate(true, 1), right);
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 12; ++y) field.occupancy[field.at(6, y, z)].x = .5F;
  EXPECT_NEAR(flux(field, propagate(true, 1), right), .5 * open, 1e-5 * open);
}

// A cell closed on all six sides: each order is the flux of the one before, times ρ.
TEST_F(LpvTest, OrdersInAClosedCellAreAGeometricSeries) {
  Field field(4);
  field.red[field.at(1, 2, 1)] = unit_lobe({0, 0, 1});
  const auto close = [&](int x, int y, int z, int axis) { field.occupancy[field.at(x, y, z)][axis] = 1; };
  for (int axis = 0; axis < 3; ++axis) {
    close(1, 2, 1, axis);
    close(1 + (axis == 0), 2 + (axis == 1), 1 + (axis == 2), axis);
  }
  add_source(field);
  double expected = 0, order = 1;  // albedo ½
  for (int bounces = 1; bounces <= 6; ++bounces, order *= .5) {
    expected += order;
    EXPECT_NEAR(total(field, propagate(true, 3, bounces)), expected, 1e-4 * expected) << bounces;
  }
}

// Turning everything about an axis turns the result, to rounding.
TEST_F(LpvTest, NoAxisIsSpecial) {
  Field field(9);
  add_source(field);
  std::vector<double> ahead;
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec3 n(0);
    n[axis] = 1;
    field.red.assign(field.red.size(), glm::vec4(0));
    field.red[field.at(4, 4, 4)] = unit_lobe(n);
    const auto cells = propagate(false, 3);
    glm::ivec3 at(4);
    at[axis] += 2;
    ahead.push_back(cells[field.at(at.x, at.y, at.z)].x);
  }
  EXPECT_GT(ahead[0], 0);
  EXPECT_NEAR(ahead[1], ahead[0], 1e-6 * ahead[0]);
  EXPECT_NEAR(ahead[2], ahead[0], 1e-6 * ahead[0]);
}

// A uniform field of radiance L is intensity I = 3s²L/2 in every cell and gives E = πL, whatever the normal.
TEST_F(LpvTest, GatherOfAUniformFieldIsPiTimesRadiance) {
  const double radiance = 2.5;
  Field field(4);
  field.red.assign(field.red.size(), glm::vec4(static_cast<float>(1.5 * radiance * 2 * std::sqrt(pi)), 0, 0, 0));
  add_source(field);
  add_pass(registry_, "Plane", [] {
    return PassFunctions{.reflect =
                             [](Ports& ports) {
                               const glm::ivec2 size = ports.frame_size();
                               ports.out("surface", "Surface")
                                   .texture("depth", TextureDesc::image(size, Format::r32f), Access::image_write)
                                   .texture("normal", TextureDesc::image(size, Format::rgba32f), Access::image_write);
                             },
                         .execute =
                             [](Frame& f, const Bindings& io) {
                               interop::Camera camera{};
                               camera.eye = {2, 2, 1, 0};
                               camera.forward = {0, 0, 1, 0};
                               camera.right = {.1, 0, 0, 0};
                               camera.up = {0, .1, 0, 0};
                               camera.size = {f.size(), 1.F / glm::vec2(f.size())};
                               io.publish("surface", camera);
                               io.texture("surface.depth").clear(glm::vec4(1));
                               io.texture("surface.normal").clear({.6, 0, .8, 0});
                             }};
  });
  for (const char* reconstruction : {"linear", "non-negative"}) {
    const auto renderer = make(R"({"passes": {
      "source": {"type": "Source"}, "plane": {"type": "Plane"},
      "bounce": {"type": "GatherVolume", "in": {"surface": "plane.surface", "volume": "source.flux"},
                 "params": {"reconstruction": ")" +
                               std::string(reconstruction) + R"("}}},
      "outputs": {"image": "bounce.irradiance"}})");
    frame(*renderer);
    EXPECT_NEAR(uniform_value(*renderer), pi * radiance, 1e-5 * pi * radiance) << reconstruction;
  }
}

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
}  // namespace loom
