// One pass at a time: what its shaders name is bound, what it declares is what it gets.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "graph/run/renderer.h"
#include "loom/diagnostic.h"
#include "support/render.h"

namespace loom {
namespace {

using test::add_compute;
using test::add_pass;
using test::PassFunctions;
using test::RenderTest;
using ::testing::AllOf;
using ::testing::HasSubstr;

TextureDesc image_desc(const Ports& ports, Format format = Format::rgba32f) {
  return TextureDesc::image(ports.frame_size(), format);
}

class RendererTest : public RenderTest {
 protected:
  void SetUp() override {
    RenderTest::SetUp();
    // A source of a constant, and one that adds its input to a parameter.
    write_shader("constant.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f) writeonly uniform image2D image_image;
uniform float value;
void main() {
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, imageSize(image_image)))) return;
  imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(value));
}
)");
    add_pass(registry_, "Constant", [] {
      struct State {
        float value = 1;
        std::shared_ptr<const Program> program;
      };
      const auto state = std::make_shared<State>();
      return PassFunctions{
          .params = [=](Params& p) { p.real("value", state->value, {.min = -1e6, .max = 1e6}); },
          .reflect =
              [](Ports& ports) {
                ports.out("image", "Image").texture("image", image_desc(ports), Access::image_write);
              },
          .prepare = [=](Device& d, const Bindings&) { state->program = d.program({.files = {"constant.comp"}}); },
          .execute =
              [=](Frame& f, const Bindings& b) {
                f.dispatch(*state->program, b, {f.size(), 1});
              }};
    });
  }

  std::string error_of(const std::string& pipeline) {
    try {
      const auto renderer = make(pipeline);
      frame(*renderer);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

const char* const constant = R"({ "passes": { "c": { "type": "Constant", "params": { "value": 2.5 } } },
                                  "outputs": { "image": "c.image" } })";

TEST_F(RendererTest, AParameterIsAUniformOfItsName) {
  const auto renderer = make(constant);
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 2.5f);
  const graph::ReadImage image = renderer->read("image");
  EXPECT_EQ(image.width, 16);
  EXPECT_EQ(image.height, 8);
  EXPECT_EQ(image.texels.size(), 128u);
}

TEST_F(RendererTest, SamplersBlocksAndStructsAreFoundByName) {
  write_shader("reader.comp", R"(
#include "interop/camera.h"
#include "interop/frame.h"
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D source_depth;
layout(std430) readonly buffer scratch_numbers { float number[]; };
layout(std140) uniform source_data { Camera camera; } source;
layout(std140) uniform frame_data { FrameData frame; };
layout(rgba32f) writeonly uniform image2D image_image;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  imageStore(image_image, p, vec4(texelFetch(source_depth, p, 0).r, number[1], source.camera.eye.x,
                                  float(frame.random.x) + frame.sky.r));
}
)");
  add_pass(registry_, "Source", [] {
    return PassFunctions{
        .reflect =
            [](Ports& ports) {
              ports.out("surface", "Surface").texture("depth", image_desc(ports, Format::r32f), Access::image_write);
            },
        .execute =
            [](Frame&, const Bindings& b) {
              b.texture("surface.depth").clear(glm::vec4(3));
              interop::Camera camera{};
              camera.eye.x = 40;
              b.publish("surface", camera);
            }};
  });
  const auto seen = std::make_shared<float>(0.f);
  add_pass(registry_, "Reader", [seen] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{
        .reflect =
            [](Ports& ports) {
              ports.in("source", "Surface").reads("depth");
              ports.scratch("numbers", BufferDesc{8});
              ports.out("image", "Image").texture("image", image_desc(ports), Access::image_write);
            },
        .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"reader.comp"}}); },
        .execute =
            [=](Frame& f, const Bindings& b) {
              const std::array<float, 2> numbers{1, 5};
              b.buffer("scratch.numbers").write(std::as_bytes(std::span(numbers)));
              *seen = b.data<interop::Camera>("source").eye.x;
              EXPECT_TRUE(b.has("source.depth"));
              EXPECT_FALSE(b.has("source.normal"));
              EXPECT_FALSE(b.absent("source"));
              f.dispatch(**program, b, {f.size(), 1});
            }};
  });
  scene_.sky = glm::vec3(.5f, 0, 0);
  const auto renderer = make(R"({ "passes": { "s": { "type": "Source" },
    "r": { "type": "Reader", "in": { "source": "s.surface" } } }, "outputs": { "image": "r.image" } })");
  frame(*renderer);
  EXPECT_EQ(*seen, 40);
  for (const glm::vec4& texel : renderer->read("image").texels) ASSERT_EQ(texel, glm::vec4(3, 5, 40, 7.5f));
}

TEST_F(RendererTest, RowZeroOfWhatIsReadIsTheTopOne) {
  write_shader("rows.frag", "out vec4 color;\nvoid main() { color = vec4(gl_FragCoord.y, gl_FragCoord.x, 0, 1); }\n");
  add_pass(registry_, "Rows", [] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", image_desc(p), Access::color); },
        .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"rows.frag"}}); },
        .execute = [=](Frame& f, const Bindings& b) { f.fullscreen(**program, b); }};
  });
  const auto renderer = make(R"({ "passes": { "r": { "type": "Rows" } }, "outputs": { "image": "r.image" } })");
  frame(*renderer);
  const auto image = renderer->read("image");
  EXPECT_EQ(image.texels.front(), glm::vec4(7.5f, .5f, 0, 1));
  EXPECT_EQ(image.texels.back(), glm::vec4(.5f, 15.5f, 0, 1));
  EXPECT_EQ(renderer->output("image")->read().front(), glm::vec4(.5f, .5f, 0, 1)) << "textures keep OpenGL's order";
}

TEST_F(RendererTest, WhatAShaderNamesInVainIsAnError) {
  write_shader("vain.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D source_NAME;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { imageStore(image_image, ivec2(0), texelFetch(source_NAME, ivec2(0), 0)); }
)");
  const auto with = [&](const std::string& name, const std::string& type) {
    add_pass(registry_, type, [name] {
      const auto program = std::make_shared<std::shared_ptr<const Program>>();
      return PassFunctions{
          .reflect =
              [](Ports& p) {
                p.in("source", "Surface").optional().reads("depth").reads("albedo");
                p.out("image", "Image").texture("image", image_desc(p), Access::image_write);
              },
          .prepare =
              [=](Device& d, const Bindings&) {
                *program = d.program({.files = {"vain.comp"}, .defines = {{"source_NAME", "source_" + name}}});
              },
          .execute =
              [=](Frame& f, const Bindings& b) {
                f.dispatch(**program, b, {f.size(), 1});
              }};
    });
    return error_of(R"({ "passes": { "s": { "type": "Source" }, "vain": { "type": ")" + type +
                    R"(", "in": { "source": "s.surface" } } }, "outputs": { "image": "vain.image" } })");
  };
  add_pass(registry_, "Source", [] {
    return PassFunctions{.reflect = [](Ports& p) {
      p.out("surface", "Surface")
          .texture("depth", image_desc(p, Format::r32f), Access::image_write)
          .texture("normal", image_desc(p), Access::image_write);
    }};
  });
  EXPECT_EQ(with("depth", "Good"), "no error");
  EXPECT_THAT(with("albedo", "Unmade"), AllOf(HasSubstr("'vain'"), HasSubstr("source.albedo is not made")));
  EXPECT_THAT(with("colour", "Unknown"), AllOf(HasSubstr("'vain'"), HasSubstr("no such member")));
  EXPECT_THAT(error_of(R"({ "passes": { "vain": { "type": "Good" } }, "outputs": { "image": "vain.image" } })"),
              HasSubstr("source_depth"))
      << "an unwired input";
}

TEST_F(RendererTest, UndeclaredReadsAreErrors) {
  write_shader("normal.comp", R"(
layout(local_size_x = 1) in;
uniform sampler2D source_normal;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { imageStore(image_image, ivec2(0), texelFetch(source_normal, ivec2(0), 0)); }
)");
  add_pass(registry_, "Source", [] {
    return PassFunctions{.reflect = [](Ports& p) {
      p.out("surface", "Surface")
          .texture("depth", image_desc(p, Format::r32f), Access::image_write)
          .texture("normal", image_desc(p), Access::image_write);
    }};
  });
  const auto reads = [](Ports& p) {
    p.in("source", "Surface").reads("depth");
    p.out("image", "Image").texture("image", image_desc(p), Access::image_write);
  };
  add_compute(registry_, "ByShader", "normal.comp", reads);
  add_pass(registry_, "ByCode", [=] {
    return PassFunctions{.reflect = reads,
                         .execute = [](Frame&, const Bindings& b) { (void)b.texture("source.normal"); }};
  });
  add_compute(registry_, "Declared", "normal.comp", [](Ports& p) {
    p.in("source", "Surface").reads("normal");
    p.out("image", "Image").texture("image", image_desc(p), Access::image_write);
  });
  add_compute(registry_, "WrongAccess", "normal.comp", [](Ports& p) {
    p.in("source", "Surface").reads("normal", Access::image_read);
    p.out("image", "Image").texture("image", image_desc(p), Access::image_write);
  });
  // The second consumer keeps `normal` alive, so that the first could reach it.
  const auto pipeline = [](const std::string& type) {
    return R"({ "passes": { "s": { "type": "Source" }, "x": { "type": ")" + type +
           R"(", "in": { "source": "s.surface" } }, "d": { "type": "Declared", "in": { "source": "s.surface" } } },
              "outputs": { "image": "x.image", "other": "d.image" } })";
  };
  EXPECT_THAT(error_of(pipeline("ByShader")),
              AllOf(HasSubstr("'x'"), HasSubstr("does not declare"), HasSubstr("source.normal")));
  EXPECT_THAT(error_of(pipeline("ByCode")),
              AllOf(HasSubstr("'x'"), HasSubstr("does not declare"), HasSubstr("source.normal")));
  EXPECT_THAT(error_of(pipeline("WrongAccess")), HasSubstr("declared with access"));
  EXPECT_EQ(error_of(pipeline("Declared")), "no error");
}

TEST_F(RendererTest, FailuresNameThePass) {
  add_pass(registry_, "Unprepared", [] {
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", image_desc(p), Access::image_write); },
        .prepare = [](Device& d, const Bindings&) { d.program({.files = {"not/there.comp"}}); }};
  });
  add_pass(registry_, "Thrower", [] {
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", image_desc(p), Access::image_write); },
        .execute = [](Frame&, const Bindings&) { throw std::runtime_error("boo"); }};
  });
  const auto pipeline = [](const std::string& type) {
    return R"({ "passes": { "mine": { "type": ")" + type + R"(" } }, "outputs": { "image": "mine.image" } })";
  };
  EXPECT_THAT(error_of(pipeline("Unprepared")), AllOf(HasSubstr("'mine'"), HasSubstr("not/there.comp")));
  EXPECT_THAT(error_of(pipeline("Thrower")), AllOf(HasSubstr("'mine'"), HasSubstr("boo"), HasSubstr("test.json")));
}

TEST_F(RendererTest, ParametersChangeAtRunTime) {
  add_pass(registry_, "Costly", [] {
    struct State {
      std::string mode = "one";
      int size = 4;
      std::shared_ptr<const Program> program;
    };
    const auto s = std::make_shared<State>();
    return PassFunctions{
        .params =
            [=](Params& p) {
              p.choice("mode", s->mode, {"one", "two", "broken"}, {.cost = Cost::shader});
              p.integer("size", s->size, {.min = 1, .max = 8, .cost = Cost::graph});
            },
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", image_desc(p), Access::image_write); },
        .prepare =
            [=](Device& d, const Bindings&) {
              if (s->mode == "broken") throw Error("cannot");
              s->program = d.program({.files = {"mode.comp"}, .defines = {{"MODE", s->mode == "one" ? "1." : "2."}}});
            },
        .execute =
            [=](Frame& f, const Bindings& b) {
              f.dispatch(*s->program, b, {f.size(), 1});
            }};
  });
  write_shader("mode.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(MODE)); }
)");
  const auto renderer = make(R"({ "passes": { "c": { "type": "Constant" }, "m": { "type": "Costly" } },
                                  "outputs": { "image": "c.image", "mode": "m.image" } })");
  Diagnostics diagnostics;
  EXPECT_EQ(renderer->set_param("c", "value", "9.5", diagnostics), graph::ParamChange::applied);
  EXPECT_EQ(renderer->set_param("m", "mode", "two", diagnostics), graph::ParamChange::applied);
  EXPECT_EQ(renderer->set_param("m", "size", "8", diagnostics), graph::ParamChange::needs_compile);
  EXPECT_FALSE(diagnostics.has_errors());
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 9.5f);
  EXPECT_EQ(uniform_value(*renderer, "mode"), 2);
  EXPECT_THROW(renderer->set_param("m", "mode", "broken", diagnostics), Error);
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer, "mode"), 2) << "the old value is back";
  EXPECT_EQ(renderer->set_param("c", "value", "1e9", diagnostics), graph::ParamChange::refused);
  EXPECT_EQ(renderer->set_param("c", "valeu", "1", diagnostics), graph::ParamChange::refused);
  EXPECT_EQ(renderer->set_param("cc", "value", "1", diagnostics), graph::ParamChange::refused);
  EXPECT_EQ(diagnostics.all().size(), 3u);
}

TEST_F(RendererTest, NonFiniteAndNegativeTexelsAreCounted) {
  add_pass(registry_, "Odd", [] {
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("image", "Image").texture("image", image_desc(p), Access::image_write); },
        .execute =
            [](Frame& f, const Bindings& b) {
              std::vector<glm::vec4> texels(128, glm::vec4(1));
              if (f.info().index == 1) {
                texels[3] = {NAN, 1, -1, 1};
                texels[5] = {INFINITY, -INFINITY, 0, 1};
              }
              b.texture("image.image").write(std::as_bytes(std::span(texels)));
            }};
  });
  const auto renderer =
      make(R"({ "passes": { "o": { "type": "Odd" } }, "outputs": { "image": "o.image" } })", {.check_finite = true});
  for (int i = 0; i < 3; ++i) frame(*renderer);
  const auto reports = renderer->finite_reports();
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].pass, "o");
  EXPECT_EQ(reports[0].member, "image.image");
  EXPECT_EQ(reports[0].frame, 1u);
  EXPECT_EQ(reports[0].non_finite, 3u);
  EXPECT_EQ(reports[0].negative, 2u);
}

TEST_F(RendererTest, TimesAreThereForEveryPassAndTheFrame) {
  const auto renderer = make(constant);
  for (int i = 0; i < 5; ++i) frame(*renderer);
  const auto passes = renderer->pass_times();
  ASSERT_EQ(passes.size(), 1u);
  EXPECT_EQ(passes[0].name, "c");
  EXPECT_EQ(passes[0].type, "Constant");
  EXPECT_GT(passes[0].gpu_median_ms, 0);
  EXPECT_GE(passes[0].gpu_p95_ms, passes[0].gpu_median_ms);
  EXPECT_GT(passes[0].cpu_median_ms, 0);
  const auto times = renderer->frame_times();
  EXPECT_GE(times.wall_median_ms, times.cpu_median_ms);
  EXPECT_GE(times.gpu_median_ms, passes[0].gpu_median_ms);
}

TEST_F(RendererTest, TheProgramsOwnStateIsRestored) {
  glUseProgram(0);
  GLuint mine = 0;
  glCreateFramebuffers(1, &mine);
  glBindFramebuffer(GL_FRAMEBUFFER, mine);
  glEnable(GL_BLEND);
  glDisable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDepthFunc(GL_LEQUAL);
  glViewport(1, 2, 3, 4);
  glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  const auto renderer = make(constant);
  frame(*renderer);
  const auto get = [](GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
  };
  EXPECT_EQ(get(GL_DRAW_FRAMEBUFFER_BINDING), static_cast<GLint>(mine));
  EXPECT_TRUE(glIsEnabled(GL_BLEND));
  EXPECT_FALSE(glIsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS));
  EXPECT_EQ(get(GL_DEPTH_FUNC), GL_LEQUAL);
  EXPECT_EQ(get(GL_CLIP_ORIGIN), GL_UPPER_LEFT);
  EXPECT_EQ(get(GL_CLIP_DEPTH_MODE), GL_NEGATIVE_ONE_TO_ONE);
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  EXPECT_THAT(viewport, ::testing::ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(get(GL_CURRENT_PROGRAM), 0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &mine);
  glDisable(GL_BLEND);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

TEST_F(RendererTest, UnknownOutputsAreNamed) {
  const auto renderer = make(constant);
  try {
    (void)renderer->read("imag");
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'imag'"), HasSubstr("'image'")));
  }
}

TEST_F(RendererTest, AnAbsentOutputIsZero) {
  const auto renderer = make(R"({ "passes": { "c": { "type": "Constant" } },
                                  "outputs": { "image": "c.image", "indirect": null } })");
  frame(*renderer);
  EXPECT_EQ(renderer->output("indirect"), nullptr);
  EXPECT_EQ(uniform_value(*renderer, "indirect"), 0);
  EXPECT_EQ(renderer->read("indirect").texels.size(), 128u);
}

TEST_F(RendererTest, TwoRenderersInOneContext) {
  const auto first = make(constant);
  const auto second = make(constant);
  Diagnostics diagnostics;
  second->set_param("c", "value", "7", diagnostics);
  for (int i = 0; i < 2; ++i) {
    frame(*first);
    frame(*second);
  }
  EXPECT_EQ(uniform_value(*first), 2.5f);
  EXPECT_EQ(uniform_value(*second), 7);
}

TEST_F(RendererTest, TwoContexts) {
  std::string why;
  const auto first = make(constant);
  frame(*first);
  {
    const gpu::Context other = gpu::Context::headless();
    const auto own_device = make_device();
    const auto second = graph::Renderer::create(compile(constant, {.frame_size = {4, 4}}), *own_device);
    second->render(scene_, camera_, {});
    EXPECT_EQ(uniform_value(*second), 2.5f);
    EXPECT_EQ(second->read("image").texels.size(), 16u);
  }
  test::shared_context(why);
  frame(*first);
  EXPECT_EQ(uniform_value(*first), 2.5f);
}

}  // namespace
}  // namespace loom
