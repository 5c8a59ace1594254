// The path tracer as a pass, and the rasteriser's straight light against it: two implementations check each other.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "reference/scenes.h"
#include "scene/load.h"
#include "support/bench.h"
#include "support/gl.h"

namespace loom::reference::test {
namespace {

using loom::test::Bench;
using loom::test::Texels;

class ReferencePass : public loom::test::GlTest {};

/// Largest difference of an output and a layer of a film, relative to the layer's largest value.
double difference(const Texels& texels, const Film& film, Layer layer) {
  double worst = 0, largest = 0;
  for (int y = 0; y < film.size().y; ++y) {
    for (int x = 0; x < film.size().x; ++x) {
      const glm::dvec3 expected = Film::mean(film.pixel(x, y), layer);
      const glm::dvec3 d = glm::abs(glm::dvec3(texels.at(x, film.size().y - 1 - y)) - expected);
      worst = std::max({worst, d.x, d.y, d.z});
      largest = std::max({largest, expected.x, expected.y, expected.z});
    }
  }
  return worst / largest;
}

// Each output is the path tracer's own, every frame adding its samples to those before.
TEST_F(ReferencePass, AddsUpOverFrames) {
  const auto device = make_device();
  // Eye and target are exact floats: the pass, which has the camera as floats, then sees the very same rays.
  scene::Camera camera = cornell_camera();
  camera.eye = {2.75, 2.75, -8};
  camera.target = {2.75, 2.75, 0};
  const glm::ivec2 size{20, 12};
  Bench bench(*device, cornell_box());
  bench.look(camera);
  bench.render("reference.json",
               {.size = size,
                .set = {{"reference", "samples", "16"}, {"reference", "bounces", "3"}},
                .requested = {"reference.radiance.image", "reference.direct.irradiance", "reference.emitter.irradiance",
                              "reference.bounce.irradiance", "reference.indirect.irradiance"},
                .seed = 5,
                .frames = 3});
  const Film film = render(cornell_box(), camera, size, 48, {.bounces = 3, .seed = 5});
  EXPECT_LT(difference(bench.read("reference.radiance.image"), film, Layer::radiance), 1e-6);
  EXPECT_LT(difference(bench.read("reference.emitter.irradiance"), film, Layer::emitter), 1e-6);
  EXPECT_LT(difference(bench.read("reference.bounce.irradiance"), film, Layer::bounce), 1e-6);
  EXPECT_LT(difference(bench.read("reference.indirect.irradiance"), film, Layer::indirect), 1e-6);
  EXPECT_EQ(glm::vec3(bench.read("reference.direct.irradiance").mean()), glm::vec3(0));
}

TEST_F(ReferencePass, RestsAtItsLimit) {
  const auto device = make_device();
  scene::Camera camera = cornell_camera();
  camera.eye = {2.75, 2.75, -8};
  camera.target = {2.75, 2.75, 0};
  Bench bench(*device, cornell_box());
  bench.look(camera);
  const auto after = [&](int frames) {
    return bench.image(
        "reference.json", "hdr",
        {.size = {8, 8}, .set = {{"reference", "samples", "16"}, {"reference", "limit", "24"}}, .frames = frames});
  };
  EXPECT_NE(after(1), after(2));
  EXPECT_EQ(after(2), after(3));
}

/// Where straight light is smooth: the 3×3 pixels around are lit alike within `variation` in both, and each sees one
/// surface (the normals in it add up to `flatness` or more).
bool smooth(const Film& film, const Texels& texels, int x, int y, double variation, double flatness) {
  double least = 1e300, most = 0;
  for (int j = y - 1; j <= y + 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      const PixelSums& p = film.pixel(i, j);
      const glm::dvec3 n = Film::mean(p, Layer::normal);
      if (glm::length(n) < flatness) return false;
      for (const double e :
           {Film::mean(p, Layer::direct).x, static_cast<double>(texels.at(i, film.size().y - 1 - j).x)}) {
        least = std::min(least, e);
        most = std::max(most, e);
      }
    }
  }
  return least > 0 && most < (1 + variation) * least;
}

struct Agreement {
  double ratio = 0;  ///< mean of the pass over mean of the reference
  int pixels = 0;    ///< compared
  int off = 0;       ///< of which differ by more than .5 %
};

Agreement agreement(const Film& film, const Texels& texels, double variation, double flatness) {
  double sum = 0, expected = 0;
  Agreement a;
  for (int y = 1; y + 1 < film.size().y; ++y) {
    for (int x = 1; x + 1 < film.size().x; ++x) {
      if (!smooth(film, texels, x, y, variation, flatness)) continue;
      const double truth = Film::mean(film.pixel(x, y), Layer::direct).x;
      const double value = static_cast<double>(texels.at(x, film.size().y - 1 - y).x);
      ++a.pixels;
      a.off += std::abs(value - truth) > .005 * truth ? 1 : 0;
      sum += value;
      expected += truth;
    }
  }
  a.ratio = sum / expected;
  EXPECT_GT(a.pixels, 200) << "too few to say anything";
  return a;
}

// Within .5 % in the mean, and pixel by pixel but for one in a hundred.
TEST_F(ReferencePass, DirectLightAgreesOnTheCornellBox) {
  const auto device = make_device();
  const glm::ivec2 size{96, 96};
  scene::Scene scene = cornell_box(false);
  scene.lights.push_back({.kind = scene::LightKind::point, .position = {1, 4, 1}, .intensity = {20, 20, 20}});
  Bench bench(*device, scene);
  bench.look(cornell_camera());
  const Texels direct = bench.image("direct.json", "direct.irradiance.irradiance", {.size = size});
  const Agreement a = agreement(render(scene, cornell_camera(), size, 64, {.bounces = 0}), direct, .05, .999);
  EXPECT_LE(a.off, a.pixels / 100) << "of " << a.pixels;
  EXPECT_NEAR(a.ratio, 1, .005);
}

// The stone's normal maps differ from texel to texel and the rasteriser reads them filtered: one pixel in fifty may be
// off by more.
TEST_F(ReferencePass, DirectLightAgreesOnSponza) {
  const char* scenes = std::getenv("LOOM_SCENES");
  if (scenes == nullptr || !std::filesystem::exists(std::string(scenes) + "/sponza-crytek/sponza.gltf")) {
    GTEST_SKIP() << "LOOM_SCENES names no folder with sponza-crytek/sponza.gltf";
  }
  // A sun and a view of its own: steep enough for the court's floor to be lit, from high up on the floor's lit side, so
  // that many pixels see stone in straight light. (With the sun low over the wall, few pixels are both lit and smooth.)
  Diagnostics diagnostics;
  scene::Scene scene = scene::load_gltf(std::string(scenes) + "/sponza-crytek/sponza.gltf", diagnostics);
  scene.lights = {{.kind = scene::LightKind::directional,
                   .direction = glm::normalize(glm::dvec3(-.22, -1, .18)),
                   .intensity = {20, 20, 20}}};
  const scene::Camera camera{.eye = {3, 9, -.4}, .target = {-1, 0, -.4}, .yfov_rad = glm::radians(60.)};
  const glm::ivec2 size{96, 64};
  const auto device = make_device();
  Bench bench(*device, scene);
  bench.look(camera);
  const Film film = render(scene, camera, size, 64, {.bounces = 0});
  for (const char* shadow : {"map", "ray"}) {
    SCOPED_TRACE(shadow);
    const Texels direct = bench.image("direct.json", "direct.irradiance.irradiance",
                                      {.size = size, .set = {{"direct", "shadow", shadow}, {"rsm", "size", "32"}}});
    const Agreement a = agreement(film, direct, .1, .97);
    EXPECT_LE(a.off, a.pixels / 50) << "of " << a.pixels;
    EXPECT_NEAR(a.ratio, 1, .005);
  }
}

}  // namespace
}  // namespace loom::reference::test
