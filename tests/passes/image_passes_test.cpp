// Add, Composite, Tonemap, DebugView and Shader on known texels, which Shader passes write.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "loom/diagnostic.h"
#include "support/bench.h"

namespace loom::test {
namespace {

using ::testing::HasSubstr;

class ImagePasses : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (IsSkipped()) return;
    device_ = make_device();
    SceneBuilder scene;
    scene.floor(glm::vec3(0), 1, scene.material(glm::vec3(.5))).sky({.5f, 1, 2});
    bench_ = std::make_unique<Bench>(*device_, scene.build());
    bench_->look_down(1);
  }
  /// A Shader pass whose text stores `value` (an expression of `pixel`) at each texel of its output.
  std::string source(const std::string& name, const std::string& value, const std::string& type = "Irradiance",
                     const std::string& member = "irradiance") const {
    write_shader(name + ".comp",
                 "layout(local_size_x = 4, local_size_y = 4) in;\n"
                 "layout(rgba32f) writeonly uniform image2D o_" +
                     member +
                     ";\n"
                     "void main() {\n  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);\n"
                     "  if (any(greaterThanEqual(pixel, imageSize(o_" +
                     member +
                     ")))) return;\n"
                     "  imageStore(o_" +
                     member + ", pixel, vec4(" + value + "));\n}\n");
    return '"' + name + R"(": { "type": "Shader", "file": ")" + name +
           R"(.comp", "ports": { "out": { "o": { "type": ")" + type + R"(", "format": "rgba32f" } } } })";
  }
  static std::string pipeline(const std::string& passes, const std::string& image) {
    return R"({ "passes": { )" + passes + R"( }, "outputs": { "image": ")" + image + R"(" } })";
  }
  Texels image(const std::string& passes, const std::string& output, BenchOptions options = {.size = {13, 7}}) const {
    return bench_->image(pipeline(passes, output), "image", std::move(options));
  }
  std::unique_ptr<gpu::CachingDevice> device_;
  std::unique_ptr<Bench> bench_;
};

TEST_F(ImagePasses, AddIsExact) {
  const Texels sum = image(source("a", "pixel, .25, 1") + ", " + source("b", "1e6 * pixel.x, pixel.y, .5, 1") +
                               R"(, "add": { "type": "Add", "in": { "a": "a.o", "b": "b.o" } })",
                           "add.irradiance");
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 13; ++x) {
      EXPECT_EQ(glm::vec3(sum.at(x, y)), glm::vec3(1e6f * static_cast<float>(x) + static_cast<float>(x), 2 * y, .75f));
    }
  }
}

TEST_F(ImagePasses, AddForwardsTheSideThatIsThere) {
  const std::string add =
      R"(, "dark": { "type": "AreaLight", "in": { "surface": "g.surface" } }, "g": { "type": "GBuffer" },
    "add": { "type": "Add", "in": { "a": "dark.irradiance", "b": "b.o" } })";
  SceneBuilder black;
  black.floor(glm::vec3(0), 1, black.material(glm::vec3(.5)));
  Bench bench(*device_, black.build());
  const Texels sum =
      bench.image(pipeline(source("b", "pixel, 3, 1") + add, "add.irradiance"), "image", {.size = {13, 7}});
  EXPECT_EQ(sum.at(5, 2), glm::vec4(5, 2, 3, 1));
  EXPECT_FALSE(bench.renderer().graph().pass("add")->runs);
}

TEST_F(ImagePasses, CompositeIsTheRenderingEquationOfALambertian) {
  const std::string passes = source("direct", "4, pixel, 1") + ", " + source("indirect", "1, 2, 3, 1") +
                             R"(, "g": { "type": "GBuffer" },
    "c": { "type": "Composite", "in": { "surface": "g.surface", "direct": "direct.o", "indirect": "indirect.o" } })";
  bench_->look_down(2);  // the floor fills the middle, the sky the rest
  const Texels lit = image(passes, "c.radiance", {.size = {16, 16}});
  int floor = 0, sky = 0;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const glm::dvec3 p = bench_->position(x, y, 10);
      const bool on_floor = std::max(std::abs(p.x), std::abs(p.z)) < 1;
      ++(on_floor ? floor : sky);
      const glm::vec3 expected = on_floor ? .5f / 3.14159265f * glm::vec3(5, x + 2, y + 3) : glm::vec3(.5f, 1, 2);
      // Albedo may be stored in half precision.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(lit.at(x, y)[c], expected[c], 1e-3 * expected[c]);
    }
  }
  EXPECT_EQ(floor, 64);
  EXPECT_EQ(sky, 192);
}

TEST_F(ImagePasses, CompositeTakesWhatIsMissingAsZero) {
  const std::string passes = source("direct", "4, pixel, 1") + R"(, "g": { "type": "GBuffer" },
    "c": { "type": "Composite", "in": { "surface": "g.surface", "direct": "direct.o" } })";
  bench_->look_down(.5);
  EXPECT_NEAR(image(passes, "c.radiance").at(3, 3).x, .5 / 3.14159265 * 4, 1e-3);
}

double srgb(double v) { return v <= .0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - .055; }

TEST_F(ImagePasses, TonemapCurvesAreExact) {
  // From 2⁻²⁰ to 2¹⁰ over the pixels.
  const std::string hdr = source("h", "exp2(vec3(-20 + pixel.x * 30. / 63)), 1", "Image", "image");
  for (const char* curve : {"linear", "reinhard", "aces"}) {
    const Texels shown = image(hdr + R"(, "t": { "type": "Tonemap", "in": { "hdr": "h.o" }, "params": { "curve": ")" +
                                   std::string(curve) + R"(", "exposure": 1 } })",
                               "t.image", {.size = {64, 1}});
    for (int x = 0; x < 64; ++x) {
      const double v = 2 * std::exp2(-20 + x * 30. / 63);
      const double mapped = curve[0] == 'l'   ? v
                            : curve[0] == 'r' ? v / (1 + v)
                                              : v * (2.51 * v + .03) / (v * (2.43 * v + .59) + .14);
      // A half float has 11 bits.
      EXPECT_NEAR(shown.at(x, 0).x, srgb(std::min(1., mapped)), 6e-4) << curve << ' ' << v;
    }
  }
}

TEST_F(ImagePasses, TonemapShowsZeroBlackInfinityWhiteAndNanMagenta) {
  const std::string hdr =
      source("h",
             "pixel.x == 0 ? vec3(0) : pixel.x == 1 ? vec3(uintBitsToFloat(0x7f800000u)) : "
             "pixel.x == 2 ? vec3(uintBitsToFloat(0x7fc00000u)) : pixel.x == 3 ? vec3(-1) : vec3(3e38), 1",
             "Image", "image");
  for (const char* curve : {"linear", "reinhard", "aces"}) {
    const Texels shown = image(hdr + R"(, "t": { "type": "Tonemap", "in": { "hdr": "h.o" }, "params": { "curve": ")" +
                                   std::string(curve) + R"(" } })",
                               "t.image", {.size = {5, 1}});
    EXPECT_EQ(glm::vec3(shown.at(0, 0)), glm::vec3(0)) << curve;
    EXPECT_EQ(glm::vec3(shown.at(1, 0)), glm::vec3(1)) << curve;
    EXPECT_EQ(glm::vec3(shown.at(2, 0)), glm::vec3(1, 0, 1)) << curve;
    EXPECT_EQ(glm::vec3(shown.at(3, 0)), glm::vec3(0)) << curve;
    EXPECT_EQ(glm::vec3(shown.at(4, 0)), glm::vec3(1)) << curve;
  }
}

TEST_F(ImagePasses, ShaderUniformsAreParameters) {
  write_shader("u.comp", R"(layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D base_image;
uniform float k;
uniform int n;
uniform bool flip;
uniform vec3 tint;
layout(rgba32f) writeonly uniform image2D image_image;
#if !defined(HAS_base) || defined(HAS_nothing) || !defined(HAS_image_image)
#error what is wired and made is not defined
#endif
void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(image_image)))) return;
  vec3 v = texelFetch(base_image, pixel, 0).rgb * k + tint * float(n);
  imageStore(image_image, pixel, vec4(flip ? -v : v, 1));
}
)");
  const std::string passes =
      source("h", "pixel, 0, 1", "Image", "image") + R"(, "u": { "type": "Shader", "file": "u.comp",
      "in": { "base": "h.o" },
      "ports": { "in": { "base": "Image", "nothing": { "type": "Image", "optional": true } },
                 "out": { "image": { "type": "Image", "format": "rgba32f", "size": "frame" } } },
      "uniforms": { "k": { "default": 1, "min": 0, "max": 4, "doc": "gain" },
                    "n": { "default": 2, "min": 0, "max": 9, "type": "int" },
                    "flip": { "default": false },
                    "tint": { "default": [1, 0, 0.5], "min": 0, "max": 1 } } })";
  EXPECT_EQ(glm::vec3(image(passes, "u.image").at(5, 3)), glm::vec3(7, 3, 1));
  const Texels set =
      image(passes, "u.image", {.size = {13, 7}, .set = {{"u", "k", "3"}, {"u", "flip", "true"}, {"u", "n", "0"}}});
  EXPECT_EQ(glm::vec3(set.at(5, 3)), glm::vec3(-15, -9, 0));
  try {
    image(passes, "u.image", {.size = {13, 7}, .set = {{"u", "k", "5"}}});
    ADD_FAILURE() << "a value out of range was taken";
  } catch (const BadInput& error) {
    EXPECT_EQ(error.diagnostics().all().front().code, "param-range");
  }
}

TEST_F(ImagePasses, ShaderFaultsAreAllReported) {
  try {
    image(R"("u": { "type": "Shader", "file": "u.frag",
      "ports": { "out": { "o": { "type": "ShVolume", "format": "rgba16f" }, "p": { "type": "Image", "format": "rgba17f" } } },
      "uniforms": { "k": { "default": 5, "min": 0, "max": 4 }, "m": { "min": 0, "max": 1 } } })",
          "u.o");
    ADD_FAILURE() << "faults were taken";
  } catch (const BadInput& error) {
    std::string all;
    for (const auto& diagnostic : error.diagnostics().all()) {
      all += to_string(diagnostic) + "\n";
      EXPECT_GT(diagnostic.where.line, 0);
    }
    for (const char* part : {"u.frag", "must name its members", "rgba17f", "out of its range", "needs a \"default\""})
      EXPECT_THAT(all, HasSubstr(part));
  }
}

TEST_F(ImagePasses, DebugViewLaysOutSlices) {
  write_shader("v.comp", R"(layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
layout(rgba32f) writeonly uniform image3D o_image;
void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, imageSize(o_image)))) return;
  imageStore(o_image, cell, vec4(cell, 1));
}
)");
  const std::string passes = R"("v": { "type": "Shader", "file": "v.comp",
      "ports": { "out": { "o": { "type": "Image", "format": "rgba32f", "size": [4, 4, 5] } } } },
    "d": { "type": "DebugView", "in": { "source": "v.o" }, "params": { "range_max": 8 } })";
  // Five slices: three columns, two rows of 4×4 texels, each texel 2×2 pixels.
  const Texels view = image(passes, "d.image", {.size = {24, 16}});
  for (int slice = 0; slice < 6; ++slice) {
    const int left = 8 * (slice % 3), bottom = 8 * (1 - slice / 3);
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        const glm::vec3 expected = slice == 5 ? glm::vec3(0) : glm::vec3(x / 2, y / 2, slice) / 8.f;
        ASSERT_EQ(glm::vec3(view.at(left + x, bottom + y)), expected) << slice << ' ' << x << ' ' << y;
      }
    }
  }
  const Texels one = image(passes, "d.image",
                           {.size = {8, 8}, .set = {{"d", "first", "3"}, {"d", "count", "1"}, {"d", "channel", "b"}}});
  for (const glm::vec4& texel : one.values) EXPECT_EQ(glm::vec3(texel), glm::vec3(3.f / 8));
}

TEST_F(ImagePasses, DebugViewNamesTheNearestMember) {
  try {
    image(R"("g": { "type": "GBuffer" },
      "d": { "type": "DebugView", "in": { "source": "g.surface" }, "params": { "member": "albeda" } })",
          "d.image");
    ADD_FAILURE() << "an unknown member was taken";
  } catch (const BadInput& error) {
    EXPECT_THAT(error.diagnostics().all().front().hint, HasSubstr("albedo"));
  }
}

}  // namespace
}  // namespace loom::test
