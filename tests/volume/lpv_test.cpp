// Light propagation in grids whose answers are known: flux kept, walls that leak nothing, a geometric series of
// bounces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

#include "volume/field.h"

namespace loom::test {
namespace {

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

// The lecture's blockers: B(ω) = A/s²·⟨n,−ω⟩₊ in two bands at the corners of cells. A full wall with one face blocks
// ¼ + ½ = .75 of what meets it head-on, and with a second face, whose lobe cancels the first one's, ½.
TEST_F(LpvTest, BlockersByDirectionLeakAQuarterOfAWallAndHalfOfAThinOne) {
  Field field(12);
  field.red[field.at(5, 6, 6)] = unit_lobe({1, 0, 0});
  add_source(field);
  const auto right = [](int x, int, int) { return x >= 6; };
  const double open = flux(field, propagate(true, 1), right);
  const auto wall = [&](glm::vec4 blocked) {
    for (int z = 0; z < 12; ++z)
      for (int y = 0; y < 12; ++y) field.directional[field.at(6, y, z)] = static_cast<float>(pi) * blocked;
    return flux(field, propagate(true, 1, 1, R"(, "blockers": "sh")"), right) / open;
  };
  EXPECT_NEAR(wall(unit_lobe({1, 0, 0})), .25, 1e-3);
  EXPECT_NEAR(wall(unit_lobe({1, 0, 0}) + unit_lobe({-1, 0, 0})), .5, 1e-3);
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

// ρ = 1 in a closed cell: each order gives the whole of the one before, and no more.
TEST_F(LpvTest, AWhiteCellIsBounded) {
  Field field(3);
  field.red[field.at(1, 1, 1)] = unit_lobe({0, 0, 1});
  field.occupancy.assign(field.occupancy.size(), glm::vec4(1));
  field.albedo.assign(field.albedo.size(), glm::vec4(1));
  add_source(field);
  EXPECT_NEAR(total(field, propagate(true, 4, 16)), 16, 1e-3);
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

/// The propagation in 64 bits, written down cell by cell: what is on its way, and what has left over the border.
class Walk {
 public:
  explicit Walk(const Field& field) : n_(field.n), front_(field.red.size()) {
    for (std::size_t i = 0; i < front_.size(); ++i) front_[i] = glm::dvec4(field.red[i]);
  }
  void step() {
    std::vector<glm::dvec4> next(front_.size());
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x) send({x, y, z}, next);
    front_ = next;
  }
  [[nodiscard]] const std::vector<glm::dvec4>& front() const { return front_; }
  [[nodiscard]] double flux() const {
    double sum = 0;
    for (const glm::dvec4& c : front_) sum += 2 * std::sqrt(pi) * c.x;
    return sum;
  }
  [[nodiscard]] double left() const { return left_; }

 private:
  [[nodiscard]] std::size_t at(glm::ivec3 p) const { return static_cast<std::size_t>(p.x + n_ * (p.y + n_ * p.z)); }

  void send(glm::ivec3 cell, std::vector<glm::dvec4>& next) {
    const glm::dvec4 c = front_[at(cell)];
    struct Beam {
      glm::ivec3 to;
      glm::dvec3 face;
      double flux;
    };
    std::vector<Beam> beams;
    double total = 0, clamped = 0;
    for (int i = 0; i < 6; ++i) {
      glm::ivec3 d(0);
      d[i / 2] = i % 2 == 0 ? 1 : -1;
      for (int j = 0; j < 6; ++j) {
        glm::ivec3 f(0);
        f[j / 2] = j % 2 == 0 ? 1 : -1;
        if (f == -d) continue;
        const glm::dvec3 w = glm::normalize(glm::dvec3(d) + .5 * glm::dvec3(f));
        const double omega = f == d ? .4006696847 : .4234313544;
        const double y0 = .5 / std::sqrt(pi), y1 = std::sqrt(.75 / pi);
        const double flux = omega * (y0 * c.x + y1 * (c.y * w.y + c.z * w.z + c.w * w.x));
        total += flux;
        clamped += std::max(0., flux);
        beams.push_back({cell + d, glm::dvec3(f), std::max(0., flux)});
      }
    }
    for (const Beam& beam : beams) {
      const double flux = clamped > 0 ? std::max(0., total) * beam.flux / clamped : 0;
      if (glm::any(glm::lessThan(beam.to, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(beam.to, glm::ivec3(n_)))) {
        left_ += flux;
      } else {
        next[at(beam.to)] += flux * glm::dvec4(unit_lobe(glm::vec3(beam.face)));
      }
    }
  }

  int n_;
  std::vector<glm::dvec4> front_;
  double left_ = 0;
};

// Flux in = flux on its way + flux that left over the border, at any number of steps.
TEST_F(LpvTest, FluxInIsFluxKeptPlusFluxOverTheBorder) {
  Field field(8);
  field.red[field.at(4, 3, 4)] = unit_lobe(glm::normalize(glm::vec3(.3F, -.5F, .8F)));
  add_source(field);
  Walk walk(field);
  std::vector<glm::dvec4> sum = walk.front();
  for (int steps = 1; steps <= 256; ++steps) {
    walk.step();
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += walk.front()[i];
    if ((steps & (steps - 1)) != 0) continue;
    const double kept = total(field, propagate(false, steps)) - total(field, propagate(false, steps - 1));
    EXPECT_NEAR(kept + walk.left(), 1, 1e-3) << steps;
    const auto cells = propagate(false, steps);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      ASSERT_NEAR(cells[i].x, sum[i].x, 1e-4 * sum[i].x + 1e-6) << steps;
    }
  }
}

/// A cell of light among walls of every share and albedo.
Field rubble(int n, int cascades = 1) {
  Field field(n, cascades);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t i = 0; i < field.red.size(); ++i) {
    if (unit(random) < .1F) field.red[i] = unit(random) * unit_lobe(glm::normalize(glm::vec3(unit(random), -.5F, .3F)));
    if (unit(random) < .5F) field.occupancy[i] = {unit(random), unit(random), unit(random), 0};
    field.directional[i] = .5F * unit(random) * unit_lobe({0, 1, 0});
  }
  for (glm::vec4& albedo : field.albedo) albedo = {unit(random), unit(random), unit(random), 1};
  return field;
}

// One arithmetic in two shader stages; blending adds as the other stage does.
TEST_F(LpvTest, LayeredFragmentsAgreeWithComputeBitForBit) {
  const Field field = rubble(7, 2);
  add_source(field);
  for (const std::string shares : {"faces", "sh"}) {
    const std::string blockers = R"(, "blockers": ")" + shares + '"';
    for (const int iterations : {0, 1, 6}) {
      for (const bool walls : {false, true}) {
        const auto compute = propagate(walls, iterations, 3, blockers);
        const auto fragment = propagate(walls, iterations, 3, blockers + R"(, "method": "fragment")");
        EXPECT_GT(total(field, compute), 0);
        ASSERT_EQ(compute, fragment) << iterations << walls << shares;
      }
    }
  }
}

TEST_F(LpvTest, TwiceTheLightIsTwiceTheResult) {
  Field field = rubble(8);
  add_source(field);
  const auto once = propagate(true, 8, 3);
  for (glm::vec4& c : field.red) c *= 2;
  const auto twice = propagate(true, 8, 3);
  for (std::size_t i = 0; i < once.size(); ++i) ASSERT_EQ(2.F * once[i], twice[i]);
}

// Linear but for the clamp and its rescaling: what two sources give together differs from their sum by what the clamp
// gives each, which cancels where they meet. 3 % of the light here.
TEST_F(LpvTest, TwoSourcesAreTheirSumButForTheClamp) {
  Field field = rubble(8);
  add_source(field);
  const std::vector<glm::vec4> both = field.red;
  const auto together = propagate(true, 8, 3);
  std::vector<glm::vec4> sum(both.size());
  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t i = 0; i < both.size(); ++i) field.red[i] = i % 2 == part ? both[i] : glm::vec4(0);
    const auto alone = propagate(true, 8, 3);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += alone[i];
  }
  EXPECT_NEAR(total(field, sum) / total(field, together), 1, .03);
}

// Each cascade is a grid of its own.
TEST_F(LpvTest, CascadesDoNotMix) {
  Field field(6, 2);
  field.red[field.at(3, 3, 5)] = unit_lobe({0, 0, 1});  // at the slab's end, sent towards the next
  add_source(field);
  const auto cells = propagate(false, 4);
  for (std::size_t i = cells.size() / 2; i < cells.size(); ++i) ASSERT_EQ(cells[i], glm::vec4(0));
  EXPECT_GT(total(field, cells), 1);
}

}  // namespace
}  // namespace loom::test
