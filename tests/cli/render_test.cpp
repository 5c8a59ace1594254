// loom render: what it writes, where, and that its options mean what they say.
#include <cmath>
#include <string>
#include <vector>

#include "cli/cli.h"

namespace loom::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Render = Cli;

TEST_F(Render, PngShowsTheToneMappedImageOfTheBuiltInScene) {
  const ProcessResult result = expect(0, render("direct", path("a.png")));
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(files(), ElementsAre("a.png"));
  const ImageLayers image = read_png(path("a.png"));
  EXPECT_EQ(image.width, 32);
  EXPECT_EQ(image.height, 24);
  // The left wall of a Cornell box is red: about half way up, close to the left edge of the box.
  const std::size_t pixel = 16 * 32 + 6;
  EXPECT_GT(image.channels.at("R")[pixel], 3 * image.channels.at("G")[pixel]);
}

TEST_F(Render, ExrHoldsRadianceUnlessAskedOtherwise) {
  expect(0, render("direct", path("hdr.exr")));
  const ImageLayers hdr = read_exr(path("hdr.exr"));
  EXPECT_EQ(hdr.attributes.at("loom:quantity"), "radiance");
  EXPECT_EQ(hdr.channels.size(), 3u);
  expect(0, render("rsm", path("bounce.exr"), {"--output", "bounce"}));
  EXPECT_EQ(read_exr(path("bounce.exr")).attributes.at("loom:quantity"), "irradiance");
  expect(0, render("direct", path("image.exr"), {"--output", "image"}));
  EXPECT_EQ(read_exr(path("image.exr")).attributes.at("loom:quantity"), "display");
}

TEST_F(Render, AnyMemberCanBeWritten) {
  expect(0, render("direct", path("depth.exr"), {"--output", "gbuffer.surface.depth"}));
  const ImageLayers depth = read_exr(path("depth.exr"));
  // The camera stands 8 m before the box, which is 5.592 m deep; the back wall is in the middle, straight ahead but for
  // the half pixel that the middle is off.
  EXPECT_NEAR(depth.channels.at("R")[12 * 32 + 16], 8 + 5.592, .05);
}

TEST_F(Render, PngOfRadianceSaysThatItIsClamped) {
  const ProcessResult result = expect(0, render("direct", path("hdr.png"), {"--output", "hdr"}));
  EXPECT_THAT(result.err, HasSubstr("not tone-mapped"));
  EXPECT_THAT(files(), ElementsAre("hdr.png"));
}

TEST_F(Render, AbsentOutputIsBlackAndSaidSo) {
  const ProcessResult result = expect(0, render("direct", path("indirect.exr"), {"--output", "indirect"}));
  EXPECT_THAT(result.err, HasSubstr("carries nothing"));
  const ImageLayers image = read_exr(path("indirect.exr"));
  EXPECT_EQ(image.width, 32);
  for (const float value : image.channels.at("R")) EXPECT_EQ(value, 0.f);
}

TEST_F(Render, SameCommandSameBytes) {
  for (const char* name : {"a.exr", "b.exr"}) expect(0, render("rsm", path(name), {"--seed", "7", "--samples", "2"}));
  EXPECT_EQ(text_of(path("a.exr")), text_of(path("b.exr")));
}

TEST_F(Render, AliasingChangesNothing) {
  expect(0, render("lpv", path("a.exr")));
  expect(0, render("lpv", path("b.exr"), {"--no-alias"}));
  EXPECT_EQ(text_of(path("a.exr")), text_of(path("b.exr")));
}

TEST_F(Render, SamplesSmoothEdgesAndKeepTheMean) {
  expect(0, render("direct", path("one.exr"), {"--output", "gbuffer.surface.albedo"}));
  expect(0, render("direct", path("many.exr"), {"--output", "gbuffer.surface.albedo", "--samples", "16"}));
  const std::vector<float> one = read_exr(path("one.exr")).channels.at("G");
  const std::vector<float> many = read_exr(path("many.exr")).channels.at("G");
  std::size_t same = 0;
  double sum_one = 0;
  double sum_many = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    same += std::abs(one[i] - many[i]) < 1e-6 ? 1 : 0;
    sum_one += one[i];
    sum_many += many[i];
  }
  EXPECT_LT(same, one.size());              // pixels that edges cross differ
  EXPECT_GT(same, one.size() * 6 / 10);     // faces have one albedo each
  EXPECT_NEAR(sum_many / sum_one, 1, .03);  // edges cross about 1 in 10 pixels here, errors of both signs
}

TEST_F(Render, FramesAreNumbered) {
  expect(0, render("direct", path("f_%03d.png"), {"--frames", "3", "--dt", ".5"}));
  EXPECT_THAT(files(), ElementsAre("f_000.png", "f_001.png", "f_002.png"));
  expect(0, render("direct", path("last.png"), {"--frames", "3"}));
  EXPECT_EQ(text_of(path("last.png")), text_of(path("f_002.png")));  // nothing moves in the box
}

TEST_F(Render, StatsAreAsTheContractHasThem) {
  expect(0, render("direct", path("a.png"), {"--stats", path("s.json"), "--frames", "3"}));
  const Json stats = Json::parse(text_of(path("s.json")));
  EXPECT_THAT(keys(stats), ElementsAre("version", "passes", "frame", "memory", "device", "pruned"));
  EXPECT_EQ(stats.at("version"), 1);
  ASSERT_FALSE(stats.at("passes").empty());
  for (const Json& pass : stats.at("passes")) {
    EXPECT_THAT(keys(pass), ElementsAre("name", "type", "gpu_ms", "cpu_ms"));
    EXPECT_THAT(keys(pass.at("gpu_ms")), ElementsAre("median", "p95"));
    EXPECT_GE(pass.at("gpu_ms").at("p95").get<double>(), pass.at("gpu_ms").at("median").get<double>());
  }
  EXPECT_THAT(keys(stats.at("frame")), ElementsAre("wall_ms", "gpu_ms", "cpu_ms"));
  EXPECT_GT(stats.at("frame").at("wall_ms").get<double>(), 0);
  EXPECT_THAT(keys(stats.at("memory")), ElementsAre("textures_bytes", "without_aliasing_bytes"));
  EXPECT_FALSE(stats.at("device").get<std::string>().empty());

  const ProcessResult printed = expect(0, render("direct", path("b.png"), {"--stats", "-"}));
  EXPECT_EQ(Json::parse(printed.out).at("memory"), stats.at("memory"));
}

TEST_F(Render, MemoryLimitIsCheckedBeforeAnythingIsMade) {
  const ProcessResult result = expect(2, render("direct", path("a.png"), {"--max-memory", "64K"}));
  EXPECT_THAT(result.err, HasSubstr("error[over-memory]"));
  EXPECT_THAT(result.err, HasSubstr("rsm.lights.shadow"));  // 16 MiB, the largest by far
  EXPECT_THAT(files(), IsEmpty());
  expect(0, render("direct", path("a.png"), {"--max-memory", "1G"}));
  EXPECT_THAT(files(), ElementsAre("a.png"));
}

TEST_F(Render, FiniteIsChecked) {
  expect(0, render("rsm", path("a.png"), {"--check-finite"}));
  // A pass of GLSL alone that divides by zero.
  dir_.write("nan.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f) uniform writeonly image2D image_image;
uniform float zero;
void main() { imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(zero / zero)); }
)");
  const std::string pipeline = dir_.write("nan.json", R"({ "name": "nan", "passes": { "bad": { "type": "Shader",
    "file": "nan.comp", "ports": { "out": { "image": { "type": "Image", "format": "rgba16f", "size": "frame" } } },
    "uniforms": { "zero": { "default": 0, "min": 0, "max": 1, "doc": "zero" } } } }, "outputs": { "image": "bad.image" } })");
  const std::vector<std::string> before = files();
  const ProcessResult result = expect(1, render(pipeline, path("nan.png"), {"--check-finite"}));
  EXPECT_THAT(result.err, HasSubstr("error[not-finite]"));
  EXPECT_THAT(result.err, HasSubstr("bad"));
  EXPECT_EQ(files(), before);
}

TEST_F(Render, RunFileGivesPipelineSizeAndParameters) {
  const std::string run =
      dir_.write("run.json", R"({ "pipeline": "direct.json", "size": [20, 10], "set": { "tonemap.exposure": -30 },
    "camera": { "eye": [2.78, 2.73, -8], "target": [2.78, 2.73, 0], "yfov_deg": 39 } })");
  // A run file names its pipeline beside itself.
  dir_.write("direct.json", text_of(std::string(LOOM_SOURCE_DIR) + "/pipelines/direct.json"));
  expect(0, {"render", run, "-o", path("a.png")});
  ImageLayers image = read_png(path("a.png"));
  EXPECT_EQ(image.width, 20);
  EXPECT_EQ(image.height, 10);
  for (const float value : image.channels.at("R")) EXPECT_EQ(value, 0.f);  // 2^-30 of the light
  // What the command line says wins.
  expect(0, {"render", run, "-o", path("a.png"), "--size", "12x9", "--set", "tonemap.exposure=0"});
  image = read_png(path("a.png"));
  EXPECT_EQ(image.width, 12);
  EXPECT_THAT(image.channels.at("R"), testing::Contains(testing::Gt(0.f)));
}

TEST_F(Render, CameraAsJson) {
  // From inside, looking at the green wall alone.
  expect(0, render("direct", path("a.exr"),
                   {"--output", "gbuffer.surface.albedo", "--camera",
                    R"({"eye": [2.78, 2, 2.8], "target": [0, 2, 2.8], "yfov_deg": 20})"}));
  const ImageLayers image = read_exr(path("a.exr"));
  for (const float value : image.channels.at("G")) EXPECT_FLOAT_EQ(value, image.channels.at("G").front());
}

TEST_F(Render, NoPruneIsAFlagThatMayTakeARule) {
  // A flag does not swallow what follows it: here the scene.
  expect(0, {"render", "--no-prune", "cornell-box", "-p", "direct", "-o", path("a.png"), "--size", "16x16"});
  expect(0, {"render", "--no-prune=static", "cornell-box", "-p", "direct", "-o", path("b.png"), "--size", "16x16"});
  EXPECT_EQ(text_of(path("a.png")), text_of(path("b.png")));
}

}  // namespace
}  // namespace loom::test
