// Probes in walls, walls between probes, budgets, and what must not change the light.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "../../passes/radiance_field/probe_grid.h"
#include "field_scene.h"
#include "loom/diagnostic.h"

namespace loom::test {
namespace {

class Field : public FieldTest {};

/// A room with a lamp, a box on its floor and walls of two colours.
SceneBuilder room_with_box(float power = 10) {
  SceneBuilder scene;
  add_room(scene, glm::vec3(0), glm::vec3(4), scene.material(glm::vec3(.7f, .6f, .5f)));
  scene.box({1, 0, 1}, {2.6f, 2.2f, 2.6f}, scene.material(glm::vec3(.3f, .5f, .7f)));
  scene.point({3, 3.5f, 3.2f}, glm::vec3(power));
  return scene;
}

void look_at_box(Bench& bench) { bench.look({3.8, 2, 3.8}, {1.8, 1, 1.8}, .5); }

TEST(FieldGrid, SpansTheBoxWithNearlyCubicSteps) {
  const loom::rules::Bounds box{{-2, 0, 10}, {6, 3, 10}};
  const auto grid = field::fit_probes(box, {.probes = 9, .inset = .25});
  EXPECT_EQ(glm::ivec3(grid.counts), glm::ivec3(9, 4, 2));
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = grid.lower[axis],
                 upper = lower + grid.spacing[axis] * static_cast<float>(grid.counts[axis] - 1);
    EXPECT_NEAR(lower + upper, box.low[axis] + box.high[axis], 1e-5) << axis;  // centred
    if (axis < 2) {
      EXPECT_NEAR(lower - box.low[axis], .25 * grid.spacing[axis], 1e-5) << axis;
    }
    EXPECT_NEAR(grid.spacing[axis], grid.spacing.x, .4 * grid.spacing.x) << axis;
  }
}

// Every probe that is on stands in the open, at most half a step from its grid point; the deepest ones are off.
TEST_F(Field, ProbesInsideABoxAreMovedOutOrSwitchedOff) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  const Texels states = bench.image(field_pipeline, "field.field.state",
                                    {.size = {16, 16}, .set = of_field({{"probes", "13"}, {"bounces", "1"}})});
  const auto grid =
      field::fit_probes({bench.facts().bounds_min, bench.facts().bounds_max}, {.probes = 13, .inset = .1});
  ASSERT_EQ(states.width, grid.counts.x);
  int off = 0, moved = 0, inside = 0;
  for (int z = 0; z < grid.counts.z; ++z) {
    for (int y = 0; y < grid.counts.y; ++y) {
      for (int x = 0; x < grid.counts.x; ++x) {
        const auto in_box = [](glm::vec3 p) { return p.x > 1 && p.x < 2.6f && p.y < 2.2f && p.z > 1 && p.z < 2.6f; };
        const glm::vec3 point = glm::vec3(grid.lower) + glm::vec3(x, y, z) * glm::vec3(grid.spacing);
        const glm::vec4 state = states.at(x, y, z);
        inside += in_box(point) ? 1 : 0;
        if (state.w < .5f) {
          ++off;
          EXPECT_TRUE(in_box(point)) << x << ' ' << y << ' ' << z;
          continue;
        }
        EXPECT_FALSE(in_box(point + glm::vec3(state))) << x << ' ' << y << ' ' << z;
        EXPECT_LE(glm::length(glm::vec3(state)), .5001 * field::shortest_step(grid));
        if (glm::length(glm::vec3(state)) > 0) {
          ++moved;
          EXPECT_TRUE(in_box(point)) << x << ' ' << y << ' ' << z;
        }
      }
    }
  }
  EXPECT_GT(off, 0);
  EXPECT_GT(moved, 0);
  EXPECT_EQ(off + moved, inside);
}

/// Irradiance on the far room's wall over that on the lit room's, with a wall of `thickness` grid steps in between.
double leak(Device& device, double thickness) {
  // 9 probes along 8 m, none inset: one a metre. The wall's middle lies halfway between two of them.
  const auto half = static_cast<float>(.5 * thickness);
  SceneBuilder scene;
  const int white = scene.material(glm::vec3(.7f));
  add_room(scene, {-4, 0, 0}, {.5f - half, 4, 4}, white);
  add_room(scene, {.5f + half, 0, 0}, {4, 4, 4}, white);
  scene.point({-2, 2, 2}, glm::vec3(10));
  Bench bench(device, scene.build());
  const auto wall = [&](glm::dvec3 eye, glm::dvec3 target) {
    bench.look(eye, target, .4);
    return bench
        .image(field_pipeline, "bounce.irradiance.irradiance",
               {.size = {16, 16}, .set = of_field({{"probes", "9"}, {"inset", "0"}, {"bounces", "2"}})})
        .mean()
        .x;
  };
  return wall({2.5, 2, 2}, {.5 + half, 2, 2}) / wall({-2.5, 2, 2}, {.5 - half, 2, 2});
}

TEST_F(Field, WallsLeakNoMoreThanStated) {
  // Grid steps → share of the lit side's irradiance that reaches the dark side.
  for (const auto& [thickness, most] : {std::pair{.1, .02}, {.5, .02}, {1., .02}, {2., .02}}) {
    const double measured = leak(*device_, thickness);
    RecordProperty("leak_" + std::to_string(thickness), std::to_string(measured));
    EXPECT_LE(measured, most) << thickness;
    EXPECT_GE(measured, 0);
  }
}

TEST_F(Field, TwiceTheLightIsTwiceTheResultExactly) {
  Bench once(*device_, room_with_box(10).build()), twice(*device_, room_with_box(20).build());
  look_at_box(once);
  look_at_box(twice);
  const BenchOptions options{.size = {16, 16}, .set = of_field({{"probes", "5"}})};
  const Texels a = once.image(field_pipeline, "bounce.irradiance.irradiance", options);
  const Texels b = twice.image(field_pipeline, "bounce.irradiance.irradiance", options);
  EXPECT_GT(a.mean().x, .01);
  for (std::size_t i = 0; i < a.values.size(); ++i) EXPECT_EQ(glm::vec3(b.values[i]), 2.f * glm::vec3(a.values[i]));
}

TEST_F(Field, TheSameFrameTwiceIsTheSame) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  BenchOptions options{.size = {16, 16}, .set = of_field({{"probes", "5"}})};
  const Texels first = bench.image(field_pipeline, "bounce.irradiance.irradiance", options);
  EXPECT_TRUE(bench.image(field_pipeline, "bounce.irradiance.irradiance", options) == first);
  options.alias = false;
  EXPECT_TRUE(bench.image(field_pipeline, "bounce.irradiance.irradiance", options) == first);
  options.alias = true;
  options.prune = false;  // nothing is kept
  options.frames = 2;
  EXPECT_TRUE(bench.image(field_pipeline, "bounce.irradiance.irradiance", options) == first);
  options.poison = true;
  EXPECT_TRUE(bench.image(field_pipeline, "bounce.irradiance.irradiance", options) == first);
}

// Drawn or traced, a probe sees the same scene, but for texels whose centre lies within the rasteriser's error of an
// edge.
TEST_F(Field, RaysSeeWhatIsDrawn) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  const auto render = [&](const char* capture) {
    return bench.image(field_pipeline, "bounce.irradiance.irradiance",
                       {.size = {16, 16}, .set = of_field({{"probes", "5"}, {"capture", capture}})});
  };
  const Texels drawn = render("raster"), traced = render("rays");
  double difference = 0, total = 0;
  for (std::size_t i = 0; i < drawn.values.size(); ++i) {
    difference += std::abs(static_cast<double>(drawn.values[i].x) - traced.values[i].x);
    total += drawn.values[i].x;
  }
  EXPECT_GT(total, 1);
  EXPECT_LE(difference, .01 * total);
}

TEST_F(Field, AStillSceneKeepsItsField) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  bench.render(field_pipeline, {.size = {16, 16}, .set = of_field({{"probes", "4"}}), .frames = 2});
  EXPECT_THAT(bench.renderer().kept_passes(), testing::Contains("field"));
}

// Orders are kept apart, so that after `bounces` rounds nothing is left of the start; then the pass rests.
TEST_F(Field, ABudgetConvergesToTheFullFieldExactly) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  const auto render = [&](const char* budget, int frames) {
    return bench.image(
        field_pipeline, "bounce.irradiance.irradiance",
        {.size = {16, 16}, .set = of_field({{"probes", "4"}, {"bounces", "3"}, {"budget", budget}}), .frames = frames});
  };
  const Texels full = render("0", 1);
  const int round = 4;  // of 64 probes
  double last = 1e30;
  for (const int frames : {1, round, 2 * round, 3 * round}) {
    const Texels part = render("16", frames);
    double difference = 0;
    for (std::size_t i = 0; i < full.values.size(); ++i)
      difference += std::abs(static_cast<double>(part.values[i].x) - full.values[i].x);
    EXPECT_LT(difference, last) << frames;
    last = difference;
  }
  EXPECT_EQ(last, 0);
  EXPECT_TRUE(render("16", 3 * round + 1) == full);
  EXPECT_THAT(bench.renderer().kept_passes(), testing::Contains("field"));
  EXPECT_TRUE(render("23", 10) == full);  // rounds that do not end with a frame
}

TEST_F(Field, DarkOrEmptyScenesCarryNothing) {
  SceneBuilder dark;
  add_room(dark, glm::vec3(0), glm::vec3(1), dark.material(glm::vec3(.5f)));
  Bench bench(*device_, dark.build());
  bench.look({.5, .5, .5}, {1, .5, .5}, .3);
  bench.render(field_pipeline, {.size = {8, 8}});
  EXPECT_TRUE(bench.absent("image"));
}

// Finite and not negative for extremes of what is in range.
TEST_F(Field, ExtremesStayFinite) {
  const std::vector<Overrides> extremes = {
      of_field({{"probes", "2"}, {"face_size", "1"}, {"moments", "1"}, {"order", "4"}, {"inset", "0"}}),
      of_field({{"probes", "2"}, {"face_size", "32"}, {"moments", "32"}, {"order", "0"}, {"inset", "0.5"}}),
      of_field({{"probes", "5"}, {"inside", "0"}, {"bounces", "16"}, {"behind", "1"}}),
      of_field({{"probes", "3"}, {"inside", "1"}, {"budget", "1"}, {"basis", "sg"}, {"capture", "rays"}})};
  for (const float power : {1e-6f, 1e8f}) {
    SceneBuilder scene = room_with_box(power);
    scene.point({1.5f, 1, 1.5f}, glm::vec3(power));  // inside the box
    scene.sky(glm::vec3(power));
    Bench bench(*device_, scene.build());
    look_at_box(bench);
    for (const Overrides& set : extremes) {
      const Texels e = bench.image(field_pipeline, "bounce.irradiance.irradiance", {.size = {8, 8}, .set = set});
      for (const glm::vec4& value : e.values) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_TRUE(std::isfinite(value[c]));
          ASSERT_GE(value[c], 0);
        }
      }
    }
  }
}

// Positions × k and point lights × k² leave the irradiance as it is.
TEST_F(Field, UnitsDoNotMatter) {
  const auto scaled = [&](double k) {
    scene::Scene scene = room_with_box().build();
    for (auto& mesh : scene.meshes)
      for (auto& position : mesh.primitives[0].positions) position *= static_cast<float>(k);
    for (auto& light : scene.lights) {
      light.position *= k;
      light.intensity *= static_cast<float>(k * k);
    }
    Bench bench(*device_, scene);
    bench.look(k * glm::dvec3(3.8, 2, 3.8), k * glm::dvec3(1.8, 1, 1.8), .5);
    return bench.image(field_pipeline, "bounce.irradiance.irradiance",
                       {.size = {16, 16}, .set = of_field({{"probes", "4"}})});
  };
  const Texels metres = scaled(1);
  // By powers of two to rounding of tan and the like alone; 1000 moves single texels over shadow edges.
  for (const double k : {1. / 1024, 1024.}) {
    const Texels other = scaled(k);
    double difference = 0, total = 0;
    for (std::size_t i = 0; i < metres.values.size(); ++i) {
      difference += std::pow(static_cast<double>(other.values[i].x) - metres.values[i].x, 2);
      total += std::pow(static_cast<double>(metres.values[i].x), 2);
    }
    EXPECT_LE(std::sqrt(difference / total), 1e-4) << k;
  }
}

TEST_F(Field, TooManyProbesAreRefusedByName) {
  Bench bench(*device_, room_with_box().build());
  look_at_box(bench);
  try {
    bench.render(field_pipeline, {.size = {8, 8}, .set = of_field({{"probes", "64"}, {"face_size", "32"}})});
    FAIL() << "rendered";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("probes"));
  }
}

}  // namespace
}  // namespace loom::test
