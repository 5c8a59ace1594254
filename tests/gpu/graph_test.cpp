// Graphs of several passes: histories, aliasing, kept outputs, external inputs, poison.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "loom/diagnostic.h"
#include "support/render.h"

namespace loom {
namespace {

using test::add_compute;
using test::add_pass;
using test::PassFunctions;
using test::RenderTest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GraphTest : public RenderTest {
 protected:
  void SetUp() override {
    RenderTest::SetUp();
    write_shader("plus_one.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler2D before_image;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy);
              imageStore(image_image, p, texelFetch(before_image, p, 0) + 1.); }
)");
    add_compute(registry_, "PlusOne", "plus_one.comp", [](Ports& p) {
      p.in("before", "Image").reads("image");
      p.out("image", "Image").texture("image", image(p), Access::image_write).initial("image", glm::vec4(50));
    });
    // A constant that counts how often it runs and keeps its output while `key` stays.
    add_pass(registry_, "Kept", [this] {
      const auto value = std::make_shared<float>(1.f);
      return PassFunctions{.params = [=](Params& p) { p.real("value", *value, {.min = 0, .max = 100}); },
                           .reflect =
                               [](Ports& p) {
                                 p.out("image", "Image").texture("image", image(p), Access::image_write);
                                 p.keep_outputs();
                               },
                           .execute =
                               [=, this](Frame&, const Bindings& b) {
                                 ++runs_;
                                 b.texture("image.image").clear(glm::vec4(*value));
                               },
                           .fingerprint = [this](const Frame&) { return key_; }};
    });
  }
  static TextureDesc image(const Ports& ports) { return TextureDesc::image(ports.frame_size(), Format::rgba32f); }

  int runs_ = 0;
  Fingerprint key_ = 1;
};

TEST_F(GraphTest, StoresAreSeenByTheFetchesThatFollow) {
  std::string passes = R"("k": { "type": "Kept" }, "p0": { "type": "PlusOne", "in": { "before": "k.image" } })";
  for (int i = 1; i < 20; ++i)
    passes += ", \"p" + std::to_string(i) + R"(": { "type": "PlusOne", "in": { "before": "p)" + std::to_string(i - 1) +
              R"(.image" } })";
  const auto renderer = make("{ \"passes\": {" + passes + R"(}, "outputs": { "image": "p19.image" } })");
  for (const int pass : renderer->graph().order) {
    const graph::CompiledPass& compiled = renderer->graph().passes[static_cast<std::size_t>(pass)];
    if (compiled.type == "PlusOne") {
      EXPECT_NE(compiled.barriers & graph::barrier_texture_fetch, 0u) << compiled.name;
    }
  }
  for (int i = 0; i < 3; ++i) {
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), 21);
  }
}

TEST_F(GraphTest, HistoryIsTheLastFrameAndBeginsWithItsClear) {
  struct Seen {
    std::vector<bool> valid;
    std::vector<float> eye;
  };
  const auto seen = std::make_shared<Seen>();
  add_pass(registry_, "Feedback", [seen] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{
        .reflect =
            [](Ports& p) {
              p.in("before", "Image").optional().reads("image");
              p.in("camera", "Surface").optional().reads("depth");
              p.out("image", "Image").texture("image", image(p), Access::image_write).initial("image", glm::vec4(50));
              p.out("surface", "Surface").texture("depth", image(p), Access::image_write);
            },
        .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"plus_one.comp"}}); },
        .execute =
            [=](Frame& f, const Bindings& b) {
              seen->valid.push_back(b.history_valid("before"));
              seen->eye.push_back(b.data<interop::Camera>("camera").eye.x);
              interop::Camera camera{};
              camera.eye.x = static_cast<float>(f.info().index) + 10;
              b.publish("surface", camera);
              f.dispatch(**program, b, {f.size(), 1});
            }};
  });
  const auto renderer = make(R"({ "passes": { "f": { "type": "Feedback",
      "in": { "before": "f.image@prev", "camera": "f.surface@prev" } } }, "outputs": { "image": "f.image" } })");
  for (int i = 0; i < 3; ++i) {
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), static_cast<float>(51 + i)) << i;
  }
  EXPECT_THAT(seen->valid, ElementsAre(false, true, true));
  EXPECT_THAT(seen->eye, ElementsAre(0, 10, 11)) << "the struct goes with the textures";
  renderer->reset();
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 51);
  EXPECT_FALSE(seen->valid.back());
}

TEST_F(GraphTest, TheSameFrameTwiceIsTheSame) {
  write_shader("noise.comp", R"(
#include "interop/frame.h"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform frame_data { FrameData frame; };
layout(rgba32f) writeonly uniform image2D image_image;
void main() { uvec2 p = gl_GlobalInvocationID.xy; uint h = (p.x * 73856093u) ^ (p.y * 19349663u) ^ frame.random.x ^ (frame.random.y * 83492791u);
              imageStore(image_image, ivec2(p), vec4(float(h & 0xffffu), sin(float(h & 0xffu)), sqrt(float(p.x)), 1)); }
)");
  add_compute(registry_, "Noise", "noise.comp",
              [](Ports& p) { p.out("image", "Image").texture("image", image(p), Access::image_write); });
  const char* const text = R"({ "passes": { "n": { "type": "Noise" } }, "outputs": { "image": "n.image" } })";
  const auto first = make(text);
  frame(*first);
  const auto a = first->read("image").texels;
  frame(*first);
  EXPECT_NE(first->read("image").texels, a) << "another frame index, other noise";
  const auto second = make(text);
  frame(*second);
  EXPECT_EQ(second->read("image").texels, a);
}

// A chain of volumes, each made from the one before by image loads and stores; every second can share storage.
class AliasTest : public GraphTest {
 protected:
  void SetUp() override {
    GraphTest::SetUp();
    write_shader("grow.comp", R"(
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
layout(r32f) readonly uniform image3D before_red;
layout(r32f) writeonly uniform image3D volume_red;
layout(r32f) uniform image3D scratch_half;
void main() {
  ivec3 p = ivec3(gl_GlobalInvocationID);
  float sum = 0.;
  for (int i = -1; i <= 1; ++i) sum += imageLoad(before_red, clamp(p + ivec3(i, 0, 0), ivec3(0), ivec3(15))).r;
  imageStore(scratch_half, p, vec4(sum / 3.));
  imageStore(volume_red, p, vec4(sum / 3. + sin(float(p.y * p.z))));
}
)");
    write_shader("slice.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
uniform sampler3D volume_red;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy);
              imageStore(image_image, p, vec4(texelFetch(volume_red, ivec3(p, 3), 0).r)); }
)");
    write_shader("seed.comp", R"(
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
layout(r32f) writeonly uniform image3D volume_red;
void main() { ivec3 p = ivec3(gl_GlobalInvocationID); imageStore(volume_red, p, vec4(p.x + 2 * p.y - p.z)); }
)");
    const glm::ivec3 cells(16);
    const auto desc = TextureDesc::volume(16, Format::r32f);
    add_compute(
        registry_, "Seed", "seed.comp",
        [=](Ports& p) { p.out("volume", "ShVolume").texture("red", desc, Access::image_write); }, cells);
    add_compute(
        registry_, "Grow", "grow.comp",
        [=](Ports& p) {
          p.in("before", "ShVolume").reads("red", Access::image_read);
          p.scratch("half", desc, Access::image_read_write);
          p.out("volume", "ShVolume").texture("red", desc, Access::image_write);
        },
        cells);
    add_compute(registry_, "Slice", "slice.comp", [](Ports& p) {
      p.in("volume", "ShVolume").reads("red");
      p.out("image", "Image").texture("image", image(p), Access::image_write);
    });
  }
  const std::string chain = R"({ "passes": {
    "seed": { "type": "Seed" },
    "g1": { "type": "Grow", "in": { "before": "seed.volume" } },
    "g2": { "type": "Grow", "in": { "before": "g1.volume" } },
    "g3": { "type": "Grow", "in": { "before": "g2.volume" } },
    "g4": { "type": "Grow", "in": { "before": "g3.volume" } },
    "s": { "type": "Slice", "in": { "volume": "g4.volume" } },
    "s2": { "type": "Slice", "in": { "volume": "g2.volume" } } },
    "outputs": { "image": "s.image", "early": "s2.image" } })";
};

TEST_F(AliasTest, SharedStorageGivesTheSameBits) {
  const auto shared = make(chain);
  const auto own = make(chain, {}, {.alias = false});
  EXPECT_LT(shared->graph().bytes, own->graph().bytes);
  EXPECT_EQ(own->graph().bytes, own->graph().bytes_without_aliasing);
  for (int i = 0; i < 2; ++i) {
    frame(*shared);
    frame(*own);
    for (const char* output : {"image", "early"}) {
      const auto a = shared->read(output).texels;
      const auto b = own->read(output).texels;
      ASSERT_EQ(a.size(), b.size());
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])), 0) << output << " of frame " << i;
    }
  }
}

TEST_F(AliasTest, PoisonChangesNothingWhereEverythingIsDeclared) {
  const auto plain = make(chain);
  const auto poisoned = make(chain, {.poison = true});
  for (int i = 0; i < 2; ++i) {
    frame(*plain);
    frame(*poisoned);
    EXPECT_EQ(plain->read("image").texels, poisoned->read("image").texels);
  }
}

TEST_F(GraphTest, PoisonShowsWhatIsNotWritten) {
  write_shader("left.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f) writeonly uniform image2D image_image;
void main() { if (gl_GlobalInvocationID.x < 4u) imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(1)); }
)");
  add_compute(registry_, "Left", "left.comp",
              [](Ports& p) { p.out("image", "Image").texture("image", image(p), Access::image_write); });
  const char* const text = R"({ "passes": { "l": { "type": "Left" } }, "outputs": { "image": "l.image" } })";
  const auto plain = make(text);
  const auto poisoned = make(text, {.poison = true});
  frame(*plain);
  frame(*poisoned);
  EXPECT_EQ(plain->read("image").texels[15].x, 0.f);
  EXPECT_EQ(poisoned->read("image").texels[0].x, 1.f);
  EXPECT_TRUE(std::isnan(poisoned->read("image").texels[15].x));
}

TEST_F(GraphTest, PoisonShowsScratchThatWasHopedToLast) {
  // Counts up in scratch, which is storage for one frame only.
  write_shader("count.comp", R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f) uniform image2D scratch_sum;
layout(std430) buffer scratch_counter { float counter; };
layout(rgba32f) writeonly uniform image2D image_image;
void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy);
              vec4 sum = imageLoad(scratch_sum, p) + 1.; imageStore(scratch_sum, p, sum);
              imageStore(image_image, p, vec4(sum.x, counter, 0, 1)); }
)");
  add_compute(registry_, "Count", "count.comp", [](Ports& p) {
    p.scratch("sum", image(p), Access::image_read_write);
    p.scratch("counter", BufferDesc{4});
    p.out("image", "Image").texture("image", image(p), Access::image_write);
  });
  const auto renderer =
      make(R"({ "passes": { "c": { "type": "Count" } }, "outputs": { "image": "c.image" } })", {.poison = true});
  frame(*renderer);
  const glm::vec4 texel = renderer->read("image").texels[0];
  EXPECT_TRUE(std::isnan(texel.x));
  EXPECT_TRUE(std::isnan(texel.y)) << "buffers too";
}

TEST_F(GraphTest, PoisonShowsAStructThatIsNotPublished) {
  const auto seen = std::make_shared<std::vector<float>>();
  add_pass(registry_, "Once", [] {
    return PassFunctions{
        .reflect = [](Ports& p) { p.out("surface", "Surface").texture("depth", image(p), Access::image_write); },
        .execute =
            [](Frame& f, const Bindings& b) {
              interop::Camera camera{};
              camera.eye.x = 5;
              if (f.info().index == 0) b.publish("surface", camera);
            }};
  });
  add_pass(registry_, "Look", [=] {
    return PassFunctions{
        .reflect =
            [](Ports& p) {
              p.in("surface", "Surface").reads("depth");
              p.out("image", "Image").texture("image", image(p), Access::image_write);
            },
        .execute = [=](Frame&, const Bindings& b) { seen->push_back(b.data<interop::Camera>("surface").eye.x); }};
  });
  const auto renderer =
      make(R"({ "passes": { "o": { "type": "Once" }, "l": { "type": "Look", "in": { "surface": "o.surface" } } },
                                  "outputs": { "image": "l.image" } })",
           {.poison = true});
  for (int i = 0; i < 2; ++i) frame(*renderer);
  EXPECT_EQ(seen->at(0), 5);
  EXPECT_TRUE(std::isnan(seen->at(1)));
}

TEST_F(GraphTest, PoisonFillsEveryFormat) {
  for (const Format format : {Format::rgba8, Format::rgba16f, Format::r11g11b10f, Format::r32ui, Format::r32i}) {
    const std::string type = "Nothing_" + std::string(to_string(format));
    add_pass(registry_, type, [format] {
      return PassFunctions{.reflect = [format](Ports& p) {
        p.out("image", "Image").texture("image", TextureDesc::image(p.frame_size(), format), Access::image_write);
      }};
    });
    const auto renderer = make(
        R"({ "passes": { "x": { "type": ")" + type + R"(" } }, "outputs": { "image": "x.image" } })", {.poison = true});
    frame(*renderer);
    const float value = uniform_value(*renderer);
    if (format == Format::rgba8)
      EXPECT_EQ(value, 1);
    else if (format == Format::r32ui)
      EXPECT_EQ(value, 4294967296.f);
    else if (format == Format::r32i)
      EXPECT_EQ(value, -1);
    else
      EXPECT_TRUE(std::isnan(value)) << to_string(format);
  }
}

const char* const kept =
    R"({ "passes": { "k": { "type": "Kept" }, "p": { "type": "PlusOne", "in": { "before": "k.image" } } },
                              "outputs": { "image": "p.image" } })";

TEST_F(GraphTest, OutputsAreKeptWhileTheFingerprintStays) {
  const auto renderer = make(kept);
  for (int i = 0; i < 3; ++i) {
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), 2);
  }
  EXPECT_EQ(runs_, 1);
  EXPECT_THAT(renderer->kept_passes(), ElementsAre("k"));
  key_ = 2;
  frame(*renderer);
  EXPECT_EQ(runs_, 2) << "another fingerprint";
  EXPECT_THAT(renderer->kept_passes(), IsEmpty());
  Diagnostics diagnostics;
  renderer->set_param("k", "value", "5", diagnostics);
  frame(*renderer);
  EXPECT_EQ(runs_, 3) << "another parameter";
  EXPECT_EQ(uniform_value(*renderer), 6);
  frame(*renderer);
  EXPECT_EQ(runs_, 3);
  renderer->reset();
  frame(*renderer);
  EXPECT_EQ(runs_, 4) << "after a reset";
  key_ = std::nullopt;
  frame(*renderer);
  frame(*renderer);
  EXPECT_EQ(runs_, 6) << "no fingerprint";
}

TEST_F(GraphTest, KeepingCanBeSwitchedOff) {
  const auto renderer = make(kept, {.fingerprints = false});
  for (int i = 0; i < 3; ++i) frame(*renderer);
  EXPECT_EQ(runs_, 3);
}

TEST_F(GraphTest, WhatIsDownstreamOfAChangeRuns) {
  int second_runs = 0;
  add_pass(registry_, "Second", [&second_runs] {
    const auto program = std::make_shared<std::shared_ptr<const Program>>();
    return PassFunctions{
        .reflect =
            [](Ports& p) {
              p.in("before", "Image").reads("image");
              p.out("image", "Image").texture("image", image(p), Access::image_write);
              p.keep_outputs();
            },
        .prepare = [=](Device& d, const Bindings&) { *program = d.program({.files = {"plus_one.comp"}}); },
        .execute =
            [=, &second_runs](Frame& f, const Bindings& b) {
              ++second_runs;
              f.dispatch(**program, b, {f.size(), 1});
            },
        .fingerprint = [](const Frame&) { return Fingerprint(1); }};
  });
  const auto renderer = make(R"({ "passes": { "k": { "type": "Kept" },
      "s": { "type": "Second", "in": { "before": "k.image" } } }, "outputs": { "image": "s.image" } })");
  for (int i = 0; i < 3; ++i) frame(*renderer);
  EXPECT_EQ(second_runs, 1);
  EXPECT_THAT(renderer->kept_passes(), ElementsAre("k", "s"));
  Diagnostics diagnostics;
  renderer->set_param("k", "value", "7", diagnostics);
  frame(*renderer);
  EXPECT_EQ(second_runs, 2);
  EXPECT_EQ(uniform_value(*renderer), 8);
}

class ExternalTest : public GraphTest {
 protected:
  const char* const text = R"({ "inputs": { "mine": { "type": "Image" } },
      "passes": { "p": { "type": "PlusOne", "in": { "before": "inputs.mine" } } }, "outputs": { "image": "p.image" } })";
  [[nodiscard]] graph::CompileOptions options() const {
    BundleInfo info{.type = "Image"};
    info.members.push_back({.name = "image", .desc = TextureDesc::image(size_, Format::rgba32f)});
    return {.external_inputs = {{"mine", info}}};
  }
};

TEST_F(ExternalTest, TheProgramsTextureIsRead) {
  const auto renderer = make(text, {}, options());
  EXPECT_THROW(frame(*renderer), Error) << "not set yet";
  const TextureDesc desc = TextureDesc::image(size_, Format::rgba32f);
  const Texture texture(desc, "mine");
  renderer->set_input("mine", "image", texture.name(), desc);
  for (const float value : {3.f, 4.f}) {
    texture.clear(glm::vec4(value));
    frame(*renderer);
    EXPECT_EQ(uniform_value(*renderer), value + 1);
  }
  const Texture other(desc, "other");
  other.clear(glm::vec4(9));
  renderer->set_input("mine", "image", other.name(), desc);
  frame(*renderer);
  EXPECT_EQ(uniform_value(*renderer), 10);
}

TEST_F(ExternalTest, WhatDoesNotFitIsRefused) {
  const auto renderer = make(text, {}, options());
  const TextureDesc declared = TextureDesc::image(size_, Format::rgba32f);
  const TextureDesc small = TextureDesc::image({4, 4}, Format::rgba32f);
  const Texture texture(small, "small");
  const auto error = [&](const char* name, const char* member, GlName gl_name, const TextureDesc& desc) -> std::string {
    try {
      renderer->set_input(name, member, gl_name, desc);
    } catch (const BadInput& bad) {
      return bad.what();
    }
    return "accepted";
  };
  EXPECT_THAT(error("mine", "image", texture.name(), small), HasSubstr("input-mismatch"));
  EXPECT_THAT(error("mine", "image", texture.name(), declared), HasSubstr("4x4")) << "said to be what it is not";
  EXPECT_THAT(error("mine", "image", 12345, declared), HasSubstr("no texture"));
  EXPECT_THAT(error("mien", "image", texture.name(), small), HasSubstr("inputs.mine.image"));
  EXPECT_THAT(error("mine", "imagee", texture.name(), small), HasSubstr("inputs.mine.image"));
}

}  // namespace
}  // namespace loom
