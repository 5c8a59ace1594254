// Skies of run files: images and the clear sky.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "loom/harmonics.h"
#include "scene/content_hash.h"
#include "scene/load.h"
#include "scene/sky.h"
#include "support/sky_images.h"

namespace loom::scene {
namespace {

namespace fs = std::filesystem;
using test::sky_of_two_bands;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double pi = 3.14159265358979323846;

class SkyFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("sky-") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void image(const std::string& name, const std::vector<float>& red, int width = 2) const {
    ImageLayers layers{.width = width, .height = static_cast<int>(red.size()) / width};
    for (const char* channel : {"R", "G", "B"}) layers.channels[channel] = red;
    write_exr((folder_ / name).string(), layers);
  }
  void bytes(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// The scene of a run file with that sky; `warnings_` is what it said.
  Scene load(const std::string& sky) {
    bytes("run.json", R"({"sky": )" + sky + "}");
    Diagnostics diagnostics;
    Scene scene = load_setup((folder_ / "run.json").string(), "", diagnostics).scene;
    warnings_.clear();
    for (const Diagnostic& d : diagnostics.all()) warnings_ += d.code + ": " + d.message + "\n";
    return scene;
  }
  std::string refusal(const std::string& sky) {
    try {
      load(sky);
    } catch (const BadInput& error) {
      return error.what();
    }
    return "accepted";
  }
  fs::path folder_;
  std::string warnings_;
};

TEST_F(SkyFile, ImageIsScaledTurnedAndCounted) {
  image("a.exr", {1, 2, 3, 4});
  const Scene scene = load(R"({"image": "a.exr", "scale": 2, "rotation_deg": 90})");
  ASSERT_TRUE(scene.sky_image);
  EXPECT_EQ(scene.sky_image->texel(1, 0), glm::vec3(4));
  // Two rows are the two halves of the sphere: the mean of all texels.
  EXPECT_NEAR(scene.sky.x, 5, 1e-5);
  EXPECT_NEAR(scene.sky_image->rotation_rad, pi / 2, 1e-12);
  EXPECT_NE(load(R"({"image": "a.exr"})").content_hash, load(R"({"image": "a.exr", "rotation_deg": 1})").content_hash);
  const auto once = load(R"({"image": "a.exr"})").content_hash;
  image("a.exr", {1, 2, 3, 5});
  EXPECT_NE(load(R"({"image": "a.exr"})").content_hash, once);
  EXPECT_THAT(sky_json(scene), HasSubstr("a.exr"));
}

TEST_F(SkyFile, NegativeValuesAreCutOffWithAWarning) {
  image("a.exr", {-1, 2, 3, 4});
  EXPECT_EQ(load(R"({"image": "a.exr"})").sky_image->texel(0, 0), glm::vec3(0));
  EXPECT_THAT(warnings_, HasSubstr("sky-negative: 3 values"));
}

TEST_F(SkyFile, HostileImagesAreNamed) {
  image("nan.exr", {1, 1, 1, std::numeric_limits<float>::quiet_NaN()});
  image("inf.exr", {1, std::numeric_limits<float>::infinity(), 1, 1});
  EXPECT_THAT(refusal(R"({"image": "nan.exr"})"), AllOf(HasSubstr("sky-not-finite"), HasSubstr("at 1, 1")));
  EXPECT_THAT(refusal(R"({"image": "inf.exr"})"), AllOf(HasSubstr("sky-not-finite"), HasSubstr("at 1, 0")));
  EXPECT_THAT(refusal(R"({"image": "nan.exr", "scale": 0})"), HasSubstr("sky-not-finite"));
  EXPECT_THAT(refusal(R"({"image": "absent.exr"})"), AllOf(HasSubstr("bad-image"), HasSubstr("no such file")));
  EXPECT_THAT(refusal(R"({"image": "absent.hdr"})"), HasSubstr("bad-image"));
  EXPECT_THAT(refusal(R"({"image": "sky.png"})"), HasSubstr("sky-format"));
  image("whole.exr", std::vector<float>(64 * 32, 1.F), 64);
  fs::resize_file(folder_ / "whole.exr", fs::file_size(folder_ / "whole.exr") / 2);
  EXPECT_THAT(refusal(R"({"image": "whole.exr"})"), HasSubstr("bad-image"));
  bytes("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n");
  EXPECT_THAT(refusal(R"({"image": "huge.hdr"})"), AllOf(HasSubstr("bad-image"), HasSubstr("16000x16000")));
  bytes("text.hdr", "no picture");
  EXPECT_THAT(refusal(R"({"image": "text.hdr"})"), HasSubstr("bad-image"));
  ImageLayers depth{.width = 1, .height = 1, .channels = {{"Z", {1.F}}}};
  write_exr((folder_ / "depth.exr").string(), depth);
  EXPECT_THAT(refusal(R"({"image": "depth.exr"})"), HasSubstr("sky-channels"));
}

// Four texels of Radiance's shared exponent, flat: (r, g, b)·2^(e−136).
TEST_F(SkyFile, RadianceFilesAreRead) {
  const auto texel = [](int r, int e) {
    return std::string{static_cast<char>(r), static_cast<char>(64), static_cast<char>(0), static_cast<char>(e)};
  };
  bytes("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + texel(128, 129) + texel(128, 130) +
                     texel(128, 131) + texel(64, 129));
  const Scene scene = load(R"({"image": "a.hdr"})");
  ASSERT_TRUE(scene.sky_image);
  EXPECT_EQ(scene.sky_image->texel(0, 0), glm::vec3(1, .5F, 0));
  EXPECT_EQ(scene.sky_image->texel(0, 1), glm::vec3(4, 2, 0));
}

TEST_F(SkyFile, KeysOfEachKind) {
  EXPECT_THAT(refusal(R"({"radiance": [1,1,1], "scale": 2})"), HasSubstr("no key \"scale\""));
  EXPECT_THAT(refusal(R"({"image": "a.exr", "turbidity": 2})"), HasSubstr("no key \"turbidity\""));
  EXPECT_THAT(refusal(R"({"model": "cloudy", "sun_elevation_deg": 3})"), HasSubstr("it may be clear"));
  EXPECT_THAT(refusal(R"({"model": "clear"})"), HasSubstr("sun_elevation_deg"));
  EXPECT_THAT(refusal(R"({"model": "clear", "sun_elevation_deg": 91})"), HasSubstr("within 0 and 90"));
  EXPECT_THAT(refusal(R"({"model": "clear", "sun_direction": [0,-1,0]})"), HasSubstr("not point down"));
  EXPECT_THAT(refusal(R"({"model": "clear", "sun_direction": [0,1,0], "sun_azimuth_deg": 3})"),
              HasSubstr("exclude each other"));
  EXPECT_THAT(refusal(R"({"model": "clear", "sun_elevation_deg": 30, "turbidity": 1})"), HasSubstr("within 2 and 10"));
}

// −Z in the middle, +X at three quarters, +Y at the top; a quarter turn takes what +Z saw to +X.
TEST(SkyImage, LiesAsTheConventionHasIt) {
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-12; };
  EXPECT_TRUE(near(SkyImage::direction_of({.5, .5}), {0, 0, -1}));
  EXPECT_TRUE(near(SkyImage::direction_of({.75, .5}), {1, 0, 0}));
  EXPECT_TRUE(near(SkyImage::direction_of({.3, 0}), {0, 1, 0}));
  for (const glm::dvec3& axis : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)}) {
    SkyImage image = sky_of_two_bands(1, glm::dvec3(1), axis);
    EXPECT_NEAR(image.at(glm::vec3(axis)).x, 2, 2e-3);
    image.rotation_rad = pi / 2;
    EXPECT_NEAR(image.at(glm::vec3(turned_about_y(axis, pi / 2))).x, 2, 2e-3);
  }
}

// Smaller levels keep the mean over the sphere, of odd sizes too.
TEST(SkyImage, HalvingKeepsTheMean) {
  SkyImage image{.width = 37, .height = 19};
  for (int i = 0; i < 37 * 19; ++i) image.radiance.emplace_back(i % 7, i % 11, (i * i) % 5);
  const glm::vec3 mean = image.mean();
  for (; image.width > 1; image = image.halved()) EXPECT_LT(glm::length(image.mean() - mean), 1e-4) << image.width;
  EXPECT_LT(glm::length(image.radiance[0] - mean), 1e-4);
}

// a + b⟨axis,ω⟩ has √4π·a and b·√(4π/3)·axis in (y, z, x), and nothing above; turning it turns that.
TEST(SkyImage, HarmonicsOfTwoBands) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 3));
  SkyImage image = sky_of_two_bands(2, glm::dvec3(1.5), axis);
  image.rotation_rad = .4;
  const glm::dvec3 turned = turned_about_y(axis, .4);
  const auto c = image.harmonics(3);
  EXPECT_NEAR(c[0].x, 2 * std::sqrt(4 * pi), 2e-3 * c[0].x);
  EXPECT_NEAR(c[1].x, 1.5 * std::sqrt(4 * pi / 3) * turned.y, 2e-3);
  EXPECT_NEAR(c[2].x, 1.5 * std::sqrt(4 * pi / 3) * turned.z, 2e-3);
  EXPECT_NEAR(c[3].x, 1.5 * std::sqrt(4 * pi / 3) * turned.x, 2e-3);
  for (std::size_t i = 4; i < 16; ++i) EXPECT_NEAR(c[i].x, 0, 2e-3);
}

// Preetham et al., zenith luminance: 1000·((4.0453T − 4.9710)·tan χ − .2155T + 2.4192) cd/m², with the sun at 45° and
// T = 3 χ = (4/9 − 3/120)·π/2, so 7164·tan(.6589) + 1772.7 = 7318 cd/m². The row next to the zenith is .35° away from
// it.
TEST(ClearSky, HasItsLuminanceAtTheZenith) {
  const glm::dvec3 sun = glm::normalize(glm::dvec3(0, 1, -1));
  const SkyImage sky = clear_sky(sun, 3, 256);
  glm::dvec3 mean(0);
  for (int x = 0; x < sky.width; ++x) mean += glm::dvec3(sky.texel(x, 0)) / static_cast<double>(sky.width);
  const double luminance = 683 * (.2126 * mean.x + .7152 * mean.y + .0722 * mean.z);
  const double expected = 1000 * ((4.0453 * 3 - 4.9710) * std::tan((4. / 9 - 3. / 120) * pi / 2) - .2155 * 3 + 2.4192);
  EXPECT_NEAR(luminance, expected, .005 * expected);
  EXPECT_GT(mean.z, mean.x) << "it is blue";
  // Brightest towards the sun; black below the horizon.
  const glm::vec3 at_sun = sky.at(glm::vec3(sun));
  for (const glm::vec3& value : sky.radiance) EXPECT_LE(value.y, 1.05F * at_sun.y);
  EXPECT_EQ(sky.at({0, -1, 0}), glm::vec3(0));
}

}  // namespace
}  // namespace loom::scene
