// Parts of the inspector that need no OpenGL: textures as pictures, values as text, cameras, files, traces, layouts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "support/temp_dir.h"
#include "viewer/camera_control.h"
#include "viewer/export.h"
#include "viewer/file_watch.h"
#include "viewer/profile.h"
#include "viewer/texture_view.h"
#include "viewer/values.h"

namespace loom::test {
namespace {

using namespace viewer;

constexpr std::uint32_t magenta = 0xffff00ffu;

Texels texels_of(const TextureDesc& desc) { return {.desc = desc, .mip = 0, .box = level_box(desc, 0), .values = {}}; }

TEST(TextureView, FlagsWhatIsNoLight) {
  Texels texels = texels_of(TextureDesc::image({4, 1}, Format::r32f));
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float v : {nan, inf, -1.F, .5F}) texels.values.emplace_back(v, 0, 0, 1);
  TextureViewSettings settings{.encode = false};
  const TextureView view = make_view(texels, settings);
  EXPECT_THAT(view.rgba, testing::ElementsAre(magenta, magenta, magenta, 0xff808080u));
  EXPECT_EQ(view.not_finite, 2u);
  EXPECT_EQ(view.negative, 1u);
  settings.exposure = 1;
  EXPECT_EQ(make_view(texels, settings).rgba[3], 0xffffffffu);
  settings.flag = Flag::not_finite;
  EXPECT_EQ(make_view(texels, settings).rgba[2], 0xff000000u) << "a coefficient may be negative";
  settings.flag = Flag::none;
  EXPECT_NE(make_view(texels, settings).rgba[0], magenta);
}

TEST(TextureView, SlicesAVolumeAlongAnyAxis) {
  // The value of a cell is its place: 100 z + 10 y + x.
  Texels texels = texels_of({.format = Format::r32f, .kind = TextureKind::d3, .width = 4, .height = 3, .depth = 2});
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) texels.values.emplace_back(100 * z + 10 * y + x, 0, 0, 1);
  const auto value = [&](int axis, int slice, int x, int y) {
    return texel_at(texels, {.slice = slice, .axis = axis}, x, y).value().r;
  };
  EXPECT_EQ(value(2, 1, 3, 0), 123) << "row 0 is the top one";
  EXPECT_EQ(value(0, 3, 1, 2), 103) << "z to the right";
  EXPECT_EQ(value(1, 2, 3, 0), 123) << "z upwards";
  EXPECT_EQ(slice_shape(texels.desc, 0, 0).count, 4);
  EXPECT_EQ(slice_shape(texels.desc, 1, 2).width, 2);
  EXPECT_FALSE(texel_at(texels, {.slice = 2}, 0, 0)) << "there are two";
  // A slice that was read alone says the same of its own texels, and nothing of others.
  const TextureViewSettings side{.slice = 2, .axis = 0};
  Texels slice{.desc = texels.desc, .mip = 0, .box = slice_box(texels.desc, side), .values = {}};
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y) slice.values.emplace_back(100 * z + 10 * y + 2, 0, 0, 1);
  EXPECT_EQ(texel_at(slice, side, 1, 0).value().r, 122);
  EXPECT_FALSE(texel_at(slice, {.slice = 1, .axis = 0}, 1, 0));
}

TEST(TextureView, PercentilesBecomeBlackAndWhite) {
  Texels texels = texels_of(TextureDesc::image({101, 1}, Format::r32f));
  for (int i = 0; i <= 100; ++i) texels.values.emplace_back(10 + i, 0, 0, 1);
  const TextureView view = make_view(texels, {.percentiles = glm::vec2(10, 90), .encode = false});
  EXPECT_FLOAT_EQ(view.range.x, 20);
  EXPECT_FLOAT_EQ(view.range.y, 100);
  EXPECT_EQ(view.rgba[50], 0xff808080u);
}

TEST(Values, GoThereAndBack) {
  EXPECT_EQ(json_text(.1F), "0.1");
  EXPECT_EQ(json_text(glm::vec3(1, .5F, 0)), "[1,0.5,0]");
  EXPECT_EQ(json_text(std::string("a\"b")), R"("a\"b")");
  EXPECT_EQ(set_text("\"aces\""), "aces");
  EXPECT_EQ(set_text("\"16\""), "\"16\"") << "which would be read as a number";
  EXPECT_EQ(shell_word("a b'c"), R"('a b'\''c')");
}

TEST(Camera, OrbitsAtOneDistanceAndNeverTurnsOver) {
  scene::Camera camera{.eye = {0, 0, 4}, .target = {0, 0, 0}};
  for (int i = 0; i < 50; ++i) orbit(camera, {.3, .4});
  EXPECT_NEAR(glm::length(camera.eye), 4, 1e-9);
  EXPECT_LT(camera.eye.y, -3.9) << "looking up from below";
  zoom(camera, .5);
  EXPECT_NEAR(glm::length(camera.eye), 2, 1e-9);
  const glm::dvec3 before = camera.target - camera.eye;
  pan(camera, {.2, .1});
  fly(camera, {1, 2, 3});
  EXPECT_NEAR(glm::distance(camera.target - camera.eye, before), 0, 1e-9);
}

TEST(FileWatch, SeesWhatWasSavedOnce) {
  const TempDir dir;
  const std::string a = dir.write("a", "1"), b = dir.write("b", "1");
  FileWatch watch;
  watch.watch({a, b});
  EXPECT_THAT(watch.changed(), testing::IsEmpty());
  std::ofstream(a) << "22";
  watch.watch({a, b});
  EXPECT_THAT(watch.changed(), testing::ElementsAre(a)) << "though it was named again in between";
  EXPECT_THAT(watch.changed(), testing::IsEmpty());
  std::filesystem::remove(b);
  EXPECT_THAT(watch.changed(), testing::IsEmpty());
  dir.write("b", "333");
  EXPECT_THAT(watch.changed(), testing::ElementsAre(b));
}

TEST(Profile, ExportsATraceThatAddsUp) {
  Profile profile;
  profile.add({.index = 7, .start_s = 1, .passes = {{"a", 2, .5}, {"b", 3, .25}}});
  const auto json = nlohmann::json::parse(profile.chrome_trace());
  double gpu_us = 0;
  for (const auto& event : json["traceEvents"])
    if (event["ph"] == "X" && event["tid"] == 0) {
      EXPECT_EQ(event["ts"].get<double>(), gpu_us) << "passes lie end to end";
      gpu_us += event["dur"].get<double>();
    }
  EXPECT_DOUBLE_EQ(gpu_us, 5000);
}

}  // namespace
}  // namespace loom::test
