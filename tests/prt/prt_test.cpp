// PRT and VisibilityField against closed forms of sky and distant light.
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "loom/harmonics.h"
#include "scene/scene.h"
#include "scene/sky.h"
#include "support/bench.h"
#include "support/scene_builders.h"
#include "support/sky_images.h"

namespace loom::test {
namespace {

constexpr double pi = 3.14159265358979323846;

const char* const pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "field": { "type": "PRT", "params": { "points": 3, "paths": 512 } },
    "open": { "type": "VisibilityField", "params": { "points": 3, "paths": 512 } },
    "sky": { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "field.sky" } },
    "by_openness": { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "open.sky" } },
    "openness": { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "open.openness" } },
    "bounce": { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "field.bounce" } } },
  "outputs": { "image": "sky.irradiance", "bounce": "bounce.irradiance", "by_openness": "by_openness.irradiance",
               "openness": "openness.irradiance" } })";

using Overrides = std::vector<graph::Override>;

class PrtTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  static Texels image(Bench& bench, const std::string& output, Overrides set = {}) {
    return bench.image(pipeline, output, {.size = {12, 12}, .set = std::move(set), .requested = {output}});
  }
  static double mean(Bench& bench, const std::string& output, Overrides set = {}) {
    return image(bench, output, std::move(set)).mean().x;
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

/// Plates of 2 cm, metres apart, tilted by `angle` about z: nothing hides anything.
SceneBuilder plates(double angle) {
  SceneBuilder scene;
  const int black = scene.material(glm::vec3(0));
  const auto plate = [&](glm::vec3 at) {
    const glm::vec3 u = .01F * glm::vec3(std::cos(angle), std::sin(angle), 0), v{0, 0, -.01F};
    scene.quad(at - u - v, at + u - v, at + u + v, at - u + v, black);
  };
  for (const glm::vec3 at : {glm::vec3(0), glm::vec3(3, 0, 0), glm::vec3(-3, 0, 0), glm::vec3(0, 3, 0),
                             glm::vec3(0, -3, 0), glm::vec3(0, 0, 3), glm::vec3(0, 0, -3)}) {
    plate(at);
  }
  return scene;
}

void look_at_plate(Bench& bench, double angle) {
  bench.look(.1 * glm::dvec3(-std::sin(angle), std::cos(angle), 0), {0, 0, 0}, .05, {0, 0, 1});
}

// A directional light on an unblocked plane, in harmonics: E = E⊥·Σ A_l (2l+1)/(4π) P_l(cosθ), A = π, 2π/3, π/4, 0. The
// transfer is 1024 low-discrepancy paths' estimate of the identity.
TEST_F(PrtTest, AnUnblockedPlaneHasTheIrradianceOfTheHarmonics) {
  for (const double angle : {.5, 1.2}) {
    SceneBuilder scene = plates(angle);
    scene.directional({0, -1, 0}, glm::vec3(3));
    Bench bench(*device_, scene.build());
    look_at_plate(bench, angle);
    const double c = std::cos(angle);
    const std::vector<double> band{.25, .5 * c, 5. / 16 * (1.5 * c * c - .5), 0};
    double expected = 0;
    for (int order = 0; order <= 3; ++order) {
      expected += 3 * band[static_cast<std::size_t>(order)];
      const Overrides set{
          {"field", "order", std::to_string(order)}, {"field", "distant", "true"}, {"field", "paths", "1024"}};
      EXPECT_NEAR(mean(bench, "image", set), expected, .02 * 3) << angle << ' ' << order;
    }
  }
}

// Turning the environment is turning the light; a quarter turn about y takes +z to +x.
TEST_F(PrtTest, TheEnvironmentTurns) {
  const auto lit = [&](glm::vec3 direction, const char* rotation) {
    SceneBuilder scene;
    const int grey = scene.material(glm::vec3(.6F));
    scene.floor(glm::vec3(0), 2, grey);
    scene.quad({-2, 0, -1}, {2, 0, -1}, {2, 2, -1}, {-2, 2, -1}, grey);
    scene.directional(glm::normalize(direction), glm::vec3(3)).sky(glm::vec3(.5F));
    Bench bench(*device_, scene.build());
    bench.look({.5, 2, 2}, {0, .3, 0}, .4);
    const Overrides set{{"field", "distant", "true"}, {"field", "rotation", rotation}};
    return std::pair(image(bench, "image", set), image(bench, "bounce", set));
  };
  // Light from +z, turned, comes from +x.
  const auto turned = lit({0, -1, -1}, "90"), other = lit({-1, -1, 0}, "0"), still = lit({0, -1, -1}, "0");
  double moved = 0;
  for (std::size_t i = 0; i < turned.first.values.size(); ++i) {
    EXPECT_NEAR(turned.first.values[i].x, other.first.values[i].x, 1e-5);
    EXPECT_NEAR(turned.second.values[i].x, other.second.values[i].x, 1e-5);
    moved += std::abs(turned.first.values[i].x - still.first.values[i].x);
  }
  EXPECT_GT(moved, 10);
}

// A sky of two bands on an unblocked plane: E = πa + 2π/3·b⟨axis,n⟩, which two bands hold. Turning its harmonics is
// turning its image, and traces nothing anew.
TEST_F(PrtTest, ASkyOfTwoBandsAndItsTurns) {
  const double angle = .8;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, .7, .3)), n(-std::sin(angle), std::cos(angle), 0);
  const auto seen = [&](double image_turn, const char* rotation, const char* order) {
    scene::Scene scene = plates(angle).build();
    scene::SkyImage sky = sky_of_two_bands(1, glm::dvec3(1), axis);
    sky.rotation_rad = image_turn;
    scene::set_sky(scene, sky);
    Bench bench(*device_, scene);
    look_at_plate(bench, angle);
    return mean(bench, "image",
                {{"field", "rotation", rotation}, {"field", "order", order}, {"field", "paths", "1024"}});
  };
  for (const double degrees : {0., 90., 200.}) {
    const double turn = degrees * pi / 180;
    const double expected = irradiance_of_two_bands(1, glm::dvec3(1), turned_about_y(axis, turn), n).x;
    const std::string text = std::to_string(degrees);
    for (const char* order : {"1", "2"}) {
      const double by_image = seen(turn, "0", order), by_harmonics = seen(0, text.c_str(), order);
      EXPECT_NEAR(by_image, expected, .02 * pi) << degrees;
      EXPECT_NEAR(by_harmonics, by_image, 1e-5 * pi) << degrees;
    }
  }
}

// Under a constant sky of radiance L a plane gets πL: V is half the sphere, of which two bands hold all that counts.
TEST_F(PrtTest, SkyOverAPlane) {
  SceneBuilder scene;
  scene.floor(glm::vec3(0), 50, scene.material(glm::vec3(.5F))).sky(glm::vec3(2));
  Bench bench(*device_, scene.build());
  bench.look_down(5, 10);
  const Overrides set{{"field", "points", "11"}, {"open", "points", "11"}};
  EXPECT_NEAR(mean(bench, "image", set), 2 * pi, .02 * 2 * pi);
  EXPECT_NEAR(mean(bench, "by_openness", set), 2 * pi, .02 * 2 * pi);
  EXPECT_NEAR(mean(bench, "openness", set), pi, .02 * pi);
  // The plane sees no other surface: nothing but what the lattice's points see of it, below the horizon of the
  // receiver.
  EXPECT_LT(mean(bench, "bounce", set), .05 * pi);
  // What is open above the plane is the sphere without the pyramid over its square, half side a:
  // 4·atan(a²/(h√(2a²+h²))).
  bench.render(pipeline, {.size = {4, 4}, .set = set, .requested = {"open.openness.coefficients"}});
  const Texels field = bench.read("open.openness.coefficients");
  const double open = field.at(5 * 9, 1, 5).x;
  const double a = 50, h = .5 * 100 / 10.2 / 1.2;
  const double pyramid = 4 * std::atan(a * a / (h * std::sqrt(2 * a * a + h * h)));
  EXPECT_NEAR(open / std::sqrt(4 * pi), 1 - pyramid / (4 * pi), .005);
}

// Surfaces of albedo 1 under a constant sky send back what they get: L arrives from everywhere, E = πL, in the corner
// too.
TEST_F(PrtTest, AWhiteCornerUnderAConstantSkyIsAFurnace) {
  SceneBuilder scene;
  const int white = scene.material(glm::vec3(1), glm::vec3(0), true);
  scene.floor(glm::vec3(0), 1, white);
  scene.quad({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, white);
  scene.sky(glm::vec3(2));
  Bench bench(*device_, scene.build());
  bench.look({0, 1, 1.5}, {0, .1, -.8}, .3);
  const Overrides set{{"field", "bounces", "16"}};
  const Texels sky = image(bench, "image", set), bounce = image(bench, "bounce", set);
  EXPECT_GT(bounce.mean().x, .1 * pi);
  for (std::size_t i = 0; i < sky.values.size(); ++i) {
    EXPECT_NEAR(sky.values[i].x + bounce.values[i].x, 2 * pi, .04 * 2 * pi);
  }
}

// What is kept is what was traced; what is damaged is traced again.
TEST_F(PrtTest, TransferIsKept) {
  scene::Scene scene = plates(.3).build();
  scene.sky = glm::vec3(1);
  finish(scene);
  const char* const folder = std::getenv("XDG_CACHE_HOME");
  ASSERT_NE(folder, nullptr);
  const auto files = [&] {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(folder) + "/lightloom")) {
      if (entry.path().filename().string().rfind("transfer-", 0) == 0) found.push_back(entry.path());
    }
    return found;
  };
  const auto once = [&] {
    Bench bench(*device_, scene);
    look_at_plate(bench, .3);
    return image(bench, "image");
  };
  const Texels traced = once();
  const auto kept = files();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_TRUE(once() == traced);
  std::filesystem::resize_file(kept[0], 100);
  EXPECT_TRUE(once() == traced);
  EXPECT_GT(std::filesystem::file_size(kept[0]), 100U);
  // It is read, and not made anew: other bytes, another picture.
  std::vector<char> zero(std::filesystem::file_size(kept[0]), 0);
  std::ofstream(kept[0], std::ios::binary).write(zero.data(), static_cast<std::streamsize>(zero.size()));
  EXPECT_EQ(once().mean().x, 0);
}

}  // namespace
}  // namespace loom::test
