// Injection: flux kept whatever the grid, the same by atomics and by points, and blockers that are shares of a face.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/diagnostic.h"
#include "support/bench.h"
#include "support/render.h"

namespace loom::test {
namespace {

constexpr double pi = std::numbers::pi;
using Set = std::vector<graph::Override>;

/// Lights alone make flux and blockers: nothing depends on the camera but where the cascades lie.
const char* const pipeline = R"({ "passes": {
    "rsm": { "type": "RSM", "params": { "size": 128, "shadow_size": 16 } },
    "inject": { "type": "Inject", "in": { "lights": "rsm.lights" }, "params": { "grid": 8, "emission_rays": 4096 } },
    "lpv": { "type": "LPV", "in": { "flux": "inject.flux", "blockers": "inject.blockers" },
             "params": { "iterations": 8, "bounces": 2 } } },
  "outputs": { "image": "lpv.intensity.red" } })";

class Injection : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels read(Bench& bench, const std::string& output, Set set = {}) {
    return bench.image(pipeline, output, {.size = {32, 32}, .set = std::move(set)});
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// A room of 6 m, so that 8 cells are of 1 m, with a block, a lamp and a light, turned about the vertical by quarters
/// and moved.
scene::Scene room(int quarters = 0, glm::vec3 shift = glm::vec3(0), float power = 1) {
  SceneBuilder scene;
  const auto turn = [&](glm::vec3 p) {
    for (int i = 0; i < quarters; ++i) p = {p.z, p.y, -p.x};
    return p + shift;
  };
  const auto box = [&](glm::vec3 low, glm::vec3 high, int material) {
    const glm::vec3 a = turn(low), b = turn(high);
    scene.box(glm::min(a, b), glm::max(a, b), material);
  };
  box(glm::vec3(-3), glm::vec3(3), scene.material({.5F, .4F, .3F}));
  box({-2.3F, -3, -1.7F}, {-.6F, -.4F, .8F}, scene.material({.8F, .2F, .6F}));
  const int lamp = scene.material(glm::vec3(.2F), power * glm::vec3(3));
  scene.quad(turn({.3F, 2.8F, -.4F}), turn({1.2F, 2.8F, -.4F}), turn({1.2F, 2.8F, .7F}), turn({.3F, 2.8F, .7F}), lamp);
  return scene.point(turn({.7F, 1.1F, -1.2F}), power * glm::vec3(5)).build();
}

// Injection is only a change of representation: the grid holds the flux that the maps hold.
/// A half float has 11 bits; OpenGL leaves open which way it rounds, so that a value is off by up to 2⁻¹⁰ of it. Each
/// of the two sources, the light and the lamp, is rounded when it is added. What the first brings to a linear band is
/// at most 1.023327/.886227 of the constant band, to which sources only add.
TEST_F(Injection, HalfFloatsAreRoundedOnceASource) {
  Bench bench(*device_, room());
  const Set half{{"inject", "storage", "fp16"}};
  for (const char* member : {"flux.red", "flux.green", "blockers.occupancy", "blockers.directional"}) {
    const std::string output = std::string("inject.") + member;
    const Texels single = read(bench, output), stored = read(bench, output, half);
    double worst = 0, largest = 0;
    std::size_t rounded = 0;
    ASSERT_EQ(single.values.size(), stored.values.size());
    for (std::size_t i = 0; i < single.values.size(); ++i) {
      const double most = 1.023327 / .886227 * std::abs(single.values[i].x);
      for (int c = 0; c < 4; ++c) {
        const double value = single.values[i][c], off = std::abs(stored.values[i][c] - value);
        largest = std::max(largest, std::abs(value));
        rounded += off > 0 ? 1 : 0;
        worst = std::max(worst, off / (2 * (std::max(most, std::abs(value)) * 0x1p-10 + 0x1p-24)));
      }
    }
    EXPECT_GT(largest, .01) << member;
    EXPECT_LE(worst, 1) << member;
    EXPECT_GT(rounded, 0u) << member << " is not in half floats";
  }
}

/// More than a half float holds stays at its largest finite value.
TEST_F(Injection, HalfFloatsStayFinite) {
  Bench bench(*device_, room(0, glm::vec3(0), 1e9F));
  const Texels flux = read(bench, "inject.flux.red", {{"inject", "storage", "fp16"}});
  float largest = 0;
  for (const glm::vec4& value : flux.values) {
    for (int c = 0; c < 4; ++c) {
      ASSERT_TRUE(std::isfinite(value[c]));
      largest = std::max(largest, value[c]);
    }
  }
  EXPECT_EQ(largest, 65504);
}

TEST_F(Injection, InjectionKeepsTheFluxOfTheMaps) {
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
TEST_F(Injection, BlockersAreSharesOfAFaceAndALitFloorIsClosed) {
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

/// √(Σ(a−b)²/Σb²) over all coefficients.
double difference(const Texels& a, const Texels& b) {
  double error = 0, square = 0;
  for (std::size_t i = 0; i < b.values.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      error += std::pow(a.values[i][c] - b.values[i][c], 2);
      square += std::pow(b.values[i][c], 2);
    }
  }
  return std::sqrt(error / square);
}

TEST_F(Injection, OfPointsAgreesWithAtomics) {
  Bench bench(*device_, room());
  for (const char* cascades : {"1", "3"}) {
    for (const char* channel : {"red", "blue"}) {
      const std::string output = std::string("inject.flux.") + channel;
      const Texels atomics = read(bench, output, {{"inject", "cascades", cascades}});
      const Texels points = read(bench, output, {{"inject", "cascades", cascades}, {"inject", "method", "points"}});
      // Fixed point holds 2⁻³⁰ of a light's power, and blending rounds at each of some thousand adds.
      EXPECT_LT(difference(points, atomics), 1e-5) << cascades << channel;
    }
  }
  const Texels atomics = read(bench, "image");
  EXPECT_LT(difference(read(bench, "image", {{"inject", "method", "points"}}), atomics), 1e-4);
}

TEST_F(Injection, DoesNotDependOnTheSizeOfTheMaps) {
  Bench bench(*device_, room());
  const auto at = [&](const char* size) {
    return read(bench, "inject.flux.red", {{"inject", "emission_rays", "0"}, {"rsm", "size", size}});
  };
  const Texels truth = at("1024");
  for (const char* size : {"64", "128", "256", "512"}) {
    const Texels flux = at(size);
    EXPECT_NEAR(flux.mean().x / truth.mean().x, 1, .01) << size;
    // Cell by cell, texels that a cell's border cuts go to one side: the share of them falls with their width.
    EXPECT_LT(difference(flux, truth), 4 / std::stod(size)) << size;
  }
}

// Elements from half a face to a hundred-thousandth of one.
TEST_F(Injection, BlockersDoNotDependOnTheSizeOfTheMaps) {
  Bench bench(*device_, room());
  const auto mean = [&](const char* size) {
    const Texels blocked = read(bench, "inject.blockers.occupancy",
                                {{"inject", "emission_rays", "0"}, {"inject", "grid", "5"}, {"rsm", "size", size}});
    return blocked.mean().x + blocked.mean().y + blocked.mean().z;
  };
  const float truth = mean("1024");
  for (const char* size : {"128", "256", "512"}) EXPECT_NEAR(mean(size) / truth, 1, .01) << size;
}

TEST_F(Injection, TwiceTheLightIsTwiceTheResult) {
  Bench one(*device_, room()), two(*device_, room(0, glm::vec3(0), 2));
  const Texels a = read(one, "image"), b = read(two, "image");
  EXPECT_GT(a.mean().x, 0);
  for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_EQ(2.F * a.values[i], b.values[i]);
}

// By whole cells of 1 m. The grid moves exactly; positions of the maps are rounded anew, so that a texel on the border
// of two cells may change sides.
TEST_F(Injection, MovesWithTheScene) {
  Bench here(*device_, room()), there(*device_, room(0, {16, -4, 8}));
  EXPECT_LT(difference(read(there, "image"), read(here, "image")), 1e-4);
}

// Rays of emission differ after a turn, the rest turns with the scene.
TEST_F(Injection, TurnsWithTheScene) {
  Bench straight(*device_, room()), turned(*device_, room(1));
  const Set set{{"inject", "emission_rays", "0"}};
  const Texels a = read(straight, "image", set), b = read(turned, "image", set);
  Texels back = a;  // coefficients (c00, y, z, x) of what stands at p after the turn p -> (p.z, p.y, -p.x)
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const glm::vec4 c = a.at(x, y, z);
        back.values[static_cast<std::size_t>(z + 8 * (y + 8 * (7 - x)))] = {c.x, c.y, -c.w, c.z};
      }
    }
  }
  EXPECT_LT(difference(b, back), .01);
}

TEST_F(Injection, CascadesFollowTheCameraInWholeCellsAndDoNotSwim) {
  Bench bench(*device_, room());
  const Set set{{"inject", "cascades", "3"}, {"lpv", "iterations", "0"}, {"lpv", "bounces", "1"}};
  const auto at = [&](double x, double z) {
    bench.look({x, 0, z}, {x, 0, z - 1}, .5);
    return read(bench, "inject.flux.red", set);
  };
  // The finest cascade has cells of ¼ m: less than one of them moves nothing, whole ones move the content.
  const Texels first = at(.03, 1.03);
  EXPECT_TRUE(at(.04, 1.02) == first);
  for (const auto& [dx, dz] : {std::pair(1, 0), std::pair(-2, 0), std::pair(0, 3), std::pair(1, -2)}) {
    const Texels moved = at(.03 + .25 * dx, 1.03 + .25 * dz);
    int same = 0;
    for (int z = 0; z < 8; ++z) {
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
          const int from_x = x + dx, from_z = z + dz;
          if (from_x < 0 || from_x >= 8 || from_z < 0 || from_z >= 8) continue;
          ASSERT_EQ(moved.at(x, y, z), first.at(from_x, y, from_z)) << x << ' ' << y << ' ' << z;
          same += moved.at(x, y, z).x > 0 ? 1 : 0;
        }
      }
    }
    EXPECT_GT(same, 8);
  }
}

TEST_F(Injection, TheFluxOfACascadeIsThatOfTheSurfacesInIt) {
  Bench bench(*device_, room());
  bench.look({0, 0, 0}, {0, 0, -1}, .5);
  const Texels flux = read(bench, "inject.flux.red", {{"inject", "cascades", "4"}});
  const auto total = [&](int cascade) {
    double sum = 0;
    for (std::size_t i = 0; i < 512; ++i) sum += flux.values[static_cast<std::size_t>(512 * cascade) + i].x;
    return sum;
  };
  const Texels single = read(bench, "inject.flux.red");
  double alone = 0;
  for (const glm::vec4& c : single.values) alone += c.x;
  EXPECT_DOUBLE_EQ(total(3), alone);
  EXPECT_LE(total(2), total(3));
  EXPECT_LE(total(1), total(2));
  EXPECT_LE(total(0), total(1));
}

TEST_F(Injection, OneWattBesideAHundredMillionKeepsItsDigits) {
  const auto rooms = [](float left, float right) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(.5F));
    scene.box(glm::vec3(-3), glm::vec3(3), grey).box({-.5F, -3, -3}, {.5F, 3, 3}, grey);
    return scene.point({-2, .2F, .3F}, glm::vec3(left)).point({2, .2F, .3F}, glm::vec3(right)).build();
  };
  Bench both(*device_, rooms(1, 1e8F)), alone(*device_, rooms(1, 0));
  const Texels flux = read(both, "inject.flux.red"), truth = read(alone, "inject.flux.red");
  double sum = 0;
  for (int z = 0; z < 8; ++z) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 4; ++x) {
        ASSERT_NEAR(flux.at(x, y, z).x, truth.at(x, y, z).x, 1e-6F * truth.at(x, y, z).x);
        sum += truth.at(x, y, z).x;
      }
    }
  }
  EXPECT_GT(sum, 0);
}

TEST_F(Injection, IsFiniteInTheSmallestGridAndFromFarAway) {
  Bench bench(*device_, room());
  bench.look({1e6, 2e5, -3e6}, {0, 0, 0}, .5);
  for (const auto& [grid, cascades] : {std::pair("1", "1"), std::pair("1", "8"), std::pair("2", "3")}) {
    const Texels intensity = read(bench, "image", {{"inject", "grid", grid}, {"inject", "cascades", cascades}});
    for (const glm::vec4& c : intensity.values) {
      for (int i = 0; i < 4; ++i) ASSERT_TRUE(std::isfinite(c[i])) << grid << ' ' << cascades;
    }
    EXPECT_GT(intensity.mean().x, 0) << grid << ' ' << cascades;
  }
}

TEST_F(Injection, RefusesMoreSlicesThanAVolumeHas) {
  Bench bench(*device_, room());
  try {
    read(bench, "image", {{"inject", "grid", "128"}, {"inject", "cascades", "6"}});
    FAIL() << "compiled";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("inject-cells"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find("lpv-flux"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace loom::test
