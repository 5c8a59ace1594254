// Targets: what begin_raster() binds and clears, and what it leaves alone.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "loom/diagnostic.h"
#include "support/render.h"

namespace loom {
namespace {

using test::add_pass;
using test::PassFunctions;
using test::RenderTest;
using ::testing::HasSubstr;

class RasterTest : public RenderTest {
 protected:
  void SetUp() override {
    RenderTest::SetUp();
    write_shader("three.frag", R"(
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
layout(location = 2) out vec4 third;
void main() { first = vec4(1); second = vec4(2); third = vec4(3); }
)");
    // One triangle over the left half of the image at depth z.
    write_shader("half.vert", R"(
uniform float z;
void main() { gl_Position = vec4(gl_VertexID == 1 ? 0. : -1., gl_VertexID == 2 ? 3. : -1., z, 1.);
              if (gl_VertexID == 0) gl_Position.y = -3.; if (gl_VertexID == 1) gl_Position.xy = vec2(0., 0.); }
)");
    write_shader("half.frag",
                 "layout(location = 0) out vec4 first;\nuniform float shade;\nvoid main() { first = vec4(shade); }\n");
  }
  static TextureDesc target(const Ports& ports) { return TextureDesc::image(ports.frame_size(), Format::rgba32f); }

  /// Type "Three": colour outputs depth, normal, albedo of a Surface in that order, by one full-screen triangle.
  void add_three() {
    add_pass(registry_, "Three", [] {
      const auto program = std::make_shared<std::shared_ptr<const Program>>();
      return PassFunctions{
          .reflect =
              [](Ports& p) {
                p.out("surface", "Surface")
                    .texture("depth", target(p), Access::color)
                    .texture("normal", target(p), Access::color)
                    .texture("albedo", target(p), Access::color);
              },
          .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"three.frag"}}); },
          .execute = [=](Frame& f, const Bindings& b) { f.fullscreen(**program, b); }};
    });
  }
};

TEST_F(RasterTest, ColourOutputsKeepTheirLocationsWhereSomeAreUnread) {
  add_three();
  const std::string passes = R"({ "passes": { "t": { "type": "Three" } }, "outputs": )";
  const auto all =
      make(passes + R"({ "image": "t.surface.depth", "n": "t.surface.normal", "a": "t.surface.albedo" } })");
  frame(*all);
  EXPECT_EQ(uniform_value(*all, "image"), 1);
  EXPECT_EQ(uniform_value(*all, "n"), 2);
  EXPECT_EQ(uniform_value(*all, "a"), 3);
  const auto last = make(passes + R"({ "image": "t.surface.albedo" } })");
  frame(*last);
  EXPECT_EQ(uniform_value(*last), 3);
}

// Five points in one texel of the third layer, one beside it: a sum, and the last of them where the target replaces.
TEST_F(RasterTest, PointsAddUpWhereTheTargetBlends) {
  write_shader("point.vert", R"(
void main() { gl_Position = vec4(gl_VertexID == 5 ? .75 : -.75, -.5, .5, 1.); }
)");
  write_shader("point.geom", R"(
layout(points) in;
layout(points, max_vertices = 1) out;
void main() { gl_Layer = 2; gl_PointSize = 1.; gl_Position = gl_in[0].gl_Position; EmitVertex(); }
)");
  write_shader("point.frag", R"(
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 last;
void main() { sum = vec4(2); last = vec4(2); }
)");
  add_pass(registry_, "Points", [] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               TextureDesc volume = TextureDesc::volume(4, Format::rgba32f, Filter::nearest);
                               volume.height = 2;
                               p.out("sum", "Image").texture("image", volume, Access::color);
                               p.out("last", "Image").texture("image", volume, Access::color);
                             },
                         .prepare =
                             [=](Device& d, const Bindings&) {
                               *program = d.program({.files = {"point.vert", "point.geom", "point.frag"}});
                             },
                         .execute =
                             [=](Frame& f, const Bindings& b) {
                               static constexpr std::array<std::string_view, 2> targets{"sum.image", "last.image"};
                               f.begin_raster(b, targets);
                               f.blend(0, Blend::add);
                               f.points(**program, b, 4);
                               // What the targets hold stays, and blending too, until it is said otherwise.
                               f.continue_raster(b, targets);
                               f.points(**program, b, 6);
                               f.blend(0, Blend::replace);
                               f.continue_raster(b, targets);
                               f.points(**program, b, 0);
                             }};
  });
  const auto renderer = make(R"({ "passes": { "p": { "type": "Points" } },
    "outputs": { "image": "p.sum", "last": "p.last" } })");
  for (int i = 0; i < 2; ++i) {
    frame(*renderer);
    const auto sum = renderer->output("image")->read(), last = renderer->output("last")->read();
    for (std::size_t k = 0; k < sum.size(); ++k) {
      EXPECT_EQ(sum[k].x, k == 16 ? 18 : k == 19 ? 2 : 0) << k;  // layer 2 of 4×2 texels
      EXPECT_EQ(last[k].x, k == 16 || k == 19 ? 2 : 0) << k;
    }
  }
}

TEST_F(RasterTest, DepthIsReversedAndCleared) {
  // Near (z = .8) first, then far (z = .2) over it, each frame anew; and nothing on the right half.
  add_pass(registry_, "Depth", [] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               p.out("image", "Image").texture("image", target(p), Access::color);
                               p.scratch("depth", TextureDesc::image(p.frame_size(), Format::depth32f), Access::depth);
                             },
                         .prepare =
                             [=](Device& d, const Bindings&) {
                               *program = d.program({.files = {"half.vert", "half.frag"}});
                             },
                         .execute =
                             [=](Frame& f, const Bindings& b) {
                               GLuint array = 0;
                               glCreateVertexArrays(1, &array);
                               f.begin_raster(b);
                               f.bind(**program, b);
                               glBindVertexArray(array);
                               const bool swapped = f.info().index == 1;
                               for (const float z : {swapped ? .2f : .8f, swapped ? .8f : .2f}) {
                                 (*program)->set("z", z);
                                 (*program)->set("shade", z);
                                 glDrawArrays(GL_TRIANGLES, 0, 3);
                               }
                               glDeleteVertexArrays(1, &array);
                             }};
  });
  const auto renderer = make(R"({ "passes": { "d": { "type": "Depth" } }, "outputs": { "image": "d.image" } })");
  for (int i = 0; i < 2; ++i) {
    frame(*renderer);
    const auto image = renderer->read("image");
    const auto row = static_cast<std::size_t>(image.height / 2 * image.width);
    EXPECT_EQ(image.texels[row + 1].x, .8f) << i;
    EXPECT_EQ(image.texels[row + 14].x, 0.f) << i;
  }
}

TEST_F(RasterTest, LayeredTargetsGetOneTriangleALayer) {
  write_shader("layer.frag", "out vec4 first;\nvoid main() { first = vec4(10 + gl_Layer); }\n");
  for (const TextureKind kind : {TextureKind::d2_array, TextureKind::d3, TextureKind::cube}) {
    const std::string type = "Layers" + std::to_string(static_cast<int>(kind));
    add_pass(registry_, type, [kind] {
      const auto program = std::make_shared<std::shared_ptr<const Program>>();
      return PassFunctions{
          .reflect =
              [kind](Ports& p) {
                p.out("image", "Image")
                    .texture("image", {.format = Format::rgba16f, .kind = kind, .width = 4, .height = 4, .depth = 6},
                             Access::color);
              },
          .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"layer.frag"}}); },
          .execute = [=](Frame& f, const Bindings& b) { f.fullscreen(**program, b); }};
    });
    const auto renderer =
        make(R"({ "passes": { "l": { "type": ")" + type + R"(" } }, "outputs": { "image": "l.image" } })");
    frame(*renderer);
    const auto image = renderer->read("image");
    ASSERT_EQ(image.texels.size(), 96u);
    for (std::size_t i = 0; i < 96; ++i) EXPECT_EQ(image.texels[i].x, static_cast<float>(10 + i / 16));
  }
}

TEST_F(RasterTest, TargetsThatCannotBeTogetherAreAnError) {
  add_pass(registry_, "Mixed", [] {
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               p.out("image", "Image").texture("image", target(p), Access::color);
                               p.scratch("layers", TextureDesc::layers(p.frame_size(), 3, Format::rgba32f),
                                         Access::color);
                             },
                         .execute = [](Frame& f, const Bindings& b) { f.begin_raster(b); }};
  });
  const auto renderer = make(R"({ "passes": { "m": { "type": "Mixed" } }, "outputs": { "image": "m.image" } })");
  try {
    frame(*renderer);
    FAIL() << "an incomplete framebuffer was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'m'"));
    EXPECT_THAT(error.what(), HasSubstr("layered"));
  }
}

TEST_F(RasterTest, PersistentTargetsAccumulateAndOthersAreCleared) {
  write_shader("add.frag", R"(
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() { first = vec4(1); second = vec4(1); }
)");
  write_shader("show.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D persistent_sum;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy);
              imageStore(image_image, p, texelFetch(persistent_sum, p, 0)); }
)");
  add_pass(registry_, "Accumulate", [] {
    struct State {
      std::shared_ptr<const Program> add, show;
    };
    const auto s = std::make_shared<State>();
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               p.scratch("fresh", target(p), Access::color);
                               p.persistent("sum", target(p), Access::color, glm::vec4(100));
                               p.out("image", "Image").texture("image", target(p), Access::image_write);
                             },
                         .prepare =
                             [=](Device& d, const Bindings&) {
                               s->add = d.program({.files = {"add.frag"}});
                               s->show = d.program({.files = {"show.comp"}});
                             },
                         .execute =
                             [=](Frame& f, const Bindings& b) {
                               f.begin_raster(b);
                               glEnable(GL_BLEND);
                               glBlendFunc(GL_ONE, GL_ONE);
                               f.fullscreen(*s->add, b);
                               EXPECT_EQ(b.texture("scratch.fresh").read().front().x, 1.f);
                               f.barrier();
                               f.dispatch(*s->show, b, {f.size(), 1});
                             }};
  });
  const auto renderer = make(R"({ "passes": { "a": { "type": "Accumulate" } }, "outputs": { "image": "a.image" } })");
  for (int i = 1; i <= 3; ++i) {
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), static_cast<float>(100 + i));
  }
  renderer->reset();
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 101);
}

TEST_F(RasterTest, InPlaceTargetsKeepWhatTheyHold) {
  write_shader("add.frag", "out vec4 first;\nvoid main() { first = vec4(1); }\n");
  add_pass(registry_, "Base", [] {
    return PassFunctions{
        .reflect =
            [](Ports& p) {
              p.out("image", "Image").texture("image", target(p), Access::color).cleared("image", glm::vec4(4));
            },
        .execute = [](Frame& f, const Bindings& b) { f.begin_raster(b); }};
  });
  add_pass(registry_, "Over", [] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               p.in("image", "Image").reads("image", Access::color);
                               p.out("image", "Image").in_place("image");
                             },
                         .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"add.frag"}}); },
                         .execute =
                             [=](Frame& f, const Bindings& b) {
                               f.begin_raster(b);
                               glEnable(GL_BLEND);
                               glBlendFunc(GL_ONE, GL_ONE);
                               f.fullscreen(**program, b);
                             }};
  });
  const auto renderer =
      make(R"({ "passes": { "b": { "type": "Base" }, "o": { "type": "Over", "in": { "image": "b.image" } } },
                                  "outputs": { "image": "o.image" } })");
  for (int i = 0; i < 2; ++i) {
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), 5) << "cleared to 4 each frame, then 1 is added";
  }
}

TEST_F(RasterTest, ADepthOutputThatNobodyReadsStillTests) {
  add_pass(registry_, "Both", [] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{.reflect =
                             [](Ports& p) {
                               p.out("lights", "LightLayers")
                                   .texture("flux", target(p), Access::color)
                                   .texture("shadow", TextureDesc::image(p.frame_size(), Format::depth32f),
                                            Access::depth);
                             },
                         .prepare =
                             [=](Device& d, const Bindings&) {
                               *program = d.program({.files = {"half.vert", "half.frag"}});
                             },
                         .execute =
                             [=](Frame& f, const Bindings& b) {
                               GLuint array = 0;
                               glCreateVertexArrays(1, &array);
                               f.begin_raster(b);
                               f.bind(**program, b);
                               glBindVertexArray(array);
                               for (const float z : {.8f, .2f}) {
                                 (*program)->set("z", z);
                                 (*program)->set("shade", z);
                                 glDrawArrays(GL_TRIANGLES, 0, 3);
                               }
                               glDeleteVertexArrays(1, &array);
                             }};
  });
  const auto renderer = make(R"({ "passes": { "b": { "type": "Both" } }, "outputs": { "image": "b.lights.flux" } })");
  frame(*renderer);
  EXPECT_EQ(renderer->read("image").texels[4 * 16 + 1].x, .8f);
}

TEST_F(RasterTest, EachPassBeginsFromAKnownState) {
  add_pass(registry_, "Messy", [] {
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", target(p), Access::color); },
        .execute =
            [](Frame& f, const Bindings& b) {
              f.begin_raster(b);
              glEnable(GL_BLEND);
              glEnable(GL_CULL_FACE);
              glCullFace(GL_FRONT_AND_BACK);
              glEnable(GL_SCISSOR_TEST);
              glScissor(0, 0, 1, 1);
              glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
              glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
              glDepthFunc(GL_NEVER);
            }};
  });
  add_three();
  const auto renderer = make(R"({ "passes": { "m": { "type": "Messy" }, "t": { "type": "Three" } },
                                  "outputs": { "other": "m.image", "image": "t.surface.albedo" } })");
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 3);
  glCullFace(GL_BACK);
}

TEST_F(RasterTest, ShadowSamplersCompare) {
  write_shader("compare.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2DShadow lights_shadow;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { imageStore(image_image, ivec2(gl_GlobalInvocationID.xy),
                         vec4(textureLod(lights_shadow, vec3(.5, .5, .6), 0.), textureLod(lights_shadow, vec3(.5, .5, .4), 0.), 0, 1)); }
)");
  add_pass(registry_, "Map", [] {
    return PassFunctions{
        .reflect =
            [](Ports& p) {
              p.out("lights", "LightLayers")
                  .texture("shadow", TextureDesc::image({4, 4}, Format::depth32f), Access::depth);
            },
        .execute = [](Frame&, const Bindings& b) { b.texture("lights.shadow").clear(glm::vec4(.5f)); }};
  });
  test::add_compute(registry_, "Compare", "compare.comp", [](Ports& p) {
    p.in("lights", "LightLayers").reads("shadow");
    p.out("image", "Image").texture("image", target(p), Access::image_write);
  });
  const auto renderer =
      make(R"({ "passes": { "m": { "type": "Map" }, "c": { "type": "Compare", "in": { "lights": "m.lights" } } },
                                  "outputs": { "image": "c.image" } })");
  frame(*renderer);
  EXPECT_EQ(renderer->read("image").texels.front(), glm::vec4(1, 0, 0, 1)) << "reversed depth: larger is nearer";
}

}  // namespace
}  // namespace loom
