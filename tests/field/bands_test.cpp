// The rule `bands`: where the spectrum of a scene's light is known, the field keeps the order that irradiance takes.
#include <gtest/gtest.h>

#include "field/field_scene.h"
#include "support/bench.h"

namespace loom::test {
namespace {

using FieldBands = FieldTest;

TEST_F(FieldBands, MeasuredLightLowersTheOrderToWhatItTakes) {
  SceneBuilder scene;
  add_room(scene, {-1, -1, -1}, {1, 1, 1}, scene.material({.6f, .5f, .4f}));
  scene.point({.3f, .4f, .2f}, {2, 2, 2});
  Bench bench(*device_, scene.build());
  bench.look({.8, .7, .9}, {-1, -.9, -.8}, .5);
  const char* const output = "bounce.irradiance.irradiance";
  const auto field = [&](const char* order, bool rule) {
    const auto set = of_field({{"probes", "3"}, {"face_size", "4"}, {"bounces", "2"}, {"order", order}});
    BenchOptions options{.size = {16, 16}, .set = set};
    if (!rule) options.disabled_rules = {"bands"};
    return bench.image(field_pipeline, output, options);
  };
  const Texels second = field("2", true), fourth = field("4", true);
  EXPECT_FALSE(fourth == second) << "nothing is known of the light yet";
  SceneMeasurements light;
  light.probes = 1;
  light.lit_min = bench.facts().bounds_min;
  light.lit_max = bench.facts().bounds_max;
  light.radiance = {.6, .3, .1};
  bench.measured(light);
  EXPECT_TRUE(field("4", true) == second);
  EXPECT_TRUE(field("4", false) == fourth) << "--no-prune=bands";
}

}  // namespace
}  // namespace loom::test
