// What no pixel reads sleeps: the picture keeps its bits, wherever the camera goes and whatever changes.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <ostream>
#include <string>

#include <gtest/gtest.h>
#include <glm/vec4.hpp>

#include "support/bench.h"

namespace loom::test {
namespace {

/// A long corridor, lit at both ends: from one end little of the other is seen. `moving`: a post slides across it.
scene::Scene corridor(bool moving) {
  SceneBuilder scene;
  const int wall = scene.material({.7f, .5f, .3f}), post = scene.material({.2f, .4f, .6f});
  scene.quad({-1, 0, 8}, {1, 0, 8}, {1, 0, -8}, {-1, 0, -8}, wall);
  scene.quad({-1, 2, -8}, {1, 2, -8}, {1, 2, 8}, {-1, 2, 8}, wall);
  scene.quad({-1, 0, 8}, {-1, 0, -8}, {-1, 2, -8}, {-1, 2, 8}, wall);
  scene.quad({1, 0, -8}, {1, 0, 8}, {1, 2, 8}, {1, 2, -8}, wall);
  scene.quad({-1, 0, -8}, {1, 0, -8}, {1, 2, -8}, {-1, 2, -8}, wall);
  scene.point({.3f, 1.5f, 6}, glm::vec3(3)).point({-.2f, 1.4f, -6}, {1, 2, 3});
  if (moving) scene.moving({.6f, 0, 0});
  return scene.box({-.6f, 0, -6.5f}, {-.2f, 1.2f, -6.1f}, post).build();
}

struct Sleeper {
  std::string pipeline, pass, param;  ///< and the number of its cells along the longest side
  std::string state;                  ///< output that is 0 where nobody is awake
};
void PrintTo(const Sleeper& sleeper, std::ostream* out) { *out << sleeper.pipeline; }

class Sleep : public GlTest, public ::testing::WithParamInterface<Sleeper> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }

  /// The same, with the rule and without.
  struct Twins {
    Bench sleeping, awake;
    Twins(Device& device, bool moving) : sleeping(device, corridor(moving)), awake(device, corridor(moving)) {}

    template <class Change>
    void both(const Change& change) {
      change(sleeping);
      change(awake);
    }
    void render(bool poison) {
      BenchOptions options{.size = {32, 24}, .requested = {"hdr", GetParam().state}, .poison = poison};
      options.set = {{"rsm", "size", "16"},      {"rsm", "shadow_size", "128"},
                     {"voxelize", "grid", "24"}, {"radiosity", "bounces", "2"},
                     {"radiosity", "rays", "4"}, {GetParam().pass, GetParam().param, "20"}};
      sleeping.render(GetParam().pipeline, options);
      options.disabled_rules = {"sleeping-probes"};
      awake.render(GetParam().pipeline, options);
      same("first frame");
    }
    void next(const std::string& what) {
      both([](Bench& bench) { bench.next_frame(); });
      same(what);
    }
    void same(const std::string& what) {
      const Texels with = sleeping.read("hdr"), without = awake.read("hdr");
      EXPECT_TRUE(with == without) << what;
      EXPECT_GT(with.mean().x, 0) << what;
    }
  };

  static std::ptrdiff_t on(const Bench& bench) {
    const Texels state = bench.read(GetParam().state);
    return std::count_if(state.values.begin(), state.values.end(), [](glm::vec4 v) { return v != glm::vec4(0); });
  }
  static void from_lit_end(Bench& bench) { bench.look({0, 1, 6.5}, {0, .6, 7.9}, .5); }
  static void along(Bench& bench) { bench.look({0, 1, 7.5}, {0, 1, 0}, .5); }

  std::unique_ptr<gpu::CachingDevice> device_;
};

TEST_P(Sleep, KeepsTheBitsWhereverTheCameraGoes) {
  Twins twins(*device_, false);
  twins.both(from_lit_end);
  twins.render(true);
  const auto at_first = on(twins.sleeping), all = on(twins.awake);
  EXPECT_GT(at_first, 0);
  EXPECT_LT(at_first, all / 2) << "the camera sees one end";
  twins.next("still");
  EXPECT_EQ(on(twins.sleeping), at_first);
  twins.both(along);
  twins.next("further are read");
  EXPECT_GT(on(twins.sleeping), at_first);
  twins.both(from_lit_end);
  twins.next("back");
  EXPECT_GT(on(twins.sleeping), at_first) << "those that are awake stay so";
}

TEST_P(Sleep, StartsAnewWhenTheLightChanges) {
  Twins twins(*device_, false);
  twins.both(along);
  twins.render(false);
  twins.both(from_lit_end);
  twins.next("turned");
  const auto both_ends = on(twins.sleeping);
  twins.both([](Bench& bench) { bench.set("radiosity", "rays", "7"); });
  twins.next("other light on the voxels");
  EXPECT_LT(on(twins.sleeping), both_ends) << "what was made for the light before is gone";
  twins.both([](Bench& bench) { bench.reset(); });
  twins.next("reset");
}

TEST_P(Sleep, FollowsWhatMoves) {
  Twins twins(*device_, true);
  twins.both([](Bench& bench) { bench.look({0, 1, -4}, {0, .6, -6}, .5); });
  twins.render(true);
  twins.both([](Bench& bench) { bench.pose(.5); });
  twins.next("half way");
}

INSTANTIATE_TEST_SUITE_P(Pruning, Sleep,
                         ::testing::Values(Sleeper{"ray-march-probes.json", "march", "probes", "march.volume.red"},
                                           Sleeper{"radiance-field-voxel.json", "field", "probes",
                                                   "field.field.state"}),
                         [](const auto& sleeper) { return sleeper.param.pass; });

}  // namespace
}  // namespace loom::test
