#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/shader_source.h"
#include "loom/diagnostic.h"
#include "support/gl.h"

namespace loom {
namespace {

using test::GlTest;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

class ProgramTest : public GlTest {
 protected:
  std::string error_of(const ProgramDesc& desc) const {
    try {
      make_device()->program(desc);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

const char* const simple = R"(
layout(local_size_x = 8, local_size_y = 4) in;
layout(std430) writeonly buffer result { uint value[]; };
uniform uint k;
void main() { value[gl_GlobalInvocationID.x] = k + uint(OFFSET); }
)";

TEST_F(ProgramTest, RunsWithDefinesAndUniforms) {
  write_shader("a.comp", simple);
  const auto device = make_device();
  const auto program = device->program({.files = {"a.comp"}, .defines = {{"OFFSET", "5"}}});
  EXPECT_EQ(program->local_size(), glm::ivec3(8, 4, 1));
  program->set("k", 3);        // an int for a uint
  program->set("nothing", 3);  // removed or never there: nothing happens
  const Buffer buffer(std::size_t{64}, "result");
  ASSERT_EQ(program->interface().storage_blocks.size(), 1u);
  EXPECT_EQ(program->interface().storage_blocks[0].name, "result");
  glUseProgram(program->name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER,
                   static_cast<GLuint>(program->interface().storage_blocks[0].location_or_binding), buffer.name());
  glDispatchCompute(2, 1, 1);
  std::vector<unsigned> values(16);
  buffer.read(std::as_writable_bytes(std::span(values)));
  EXPECT_EQ(values, std::vector<unsigned>(16, 8));
  EXPECT_EQ(device->program({.files = {"a.comp"}, .defines = {{"OFFSET", "5"}}}), program) << "asked twice, made once";
  EXPECT_EQ(device->stats().compiled, 1);
}

TEST_F(ProgramTest, ErrorsNameFileAndLineOfTheInclude) {
  write_shader("lib2/bad.glsl", "#ifndef BAD\n#define BAD\nfloat f() {\n  return undefined_name;\n}\n#endif\n");
  write_shader(
      "b.comp",
      "layout(local_size_x = 1) in;\n#include \"lib2/bad.glsl\"\n/*\n#include \"no/such/file\"\n*/\nvoid main() {}\n");
  const std::string message = error_of({.files = {"b.comp"}});
  EXPECT_THAT(message, HasSubstr(dir() / "lib2/bad.glsl:4"));
  EXPECT_THAT(message, HasSubstr("undefined_name"));
}

TEST_F(ProgramTest, LinesCountOnAfterAnInclude) {
  write_shader("lib2/good.glsl", "float f() {\n  return 1.;\n}\n");
  write_shader("c.comp", "layout(local_size_x = 1) in;\n#include \"lib2/good.glsl\"\n\nvoid main() { oops(); }\n");
  EXPECT_THAT(error_of({.files = {"c.comp"}}), HasSubstr(dir() / "c.comp:4"));
}

TEST_F(ProgramTest, MissingIncludeSaysWhereAndWhatWasSearched) {
  write_shader("d.comp", "layout(local_size_x = 1) in;\n#include \"lib2/nowhere.glsl\"\nvoid main() {}\n");
  EXPECT_THAT(error_of({.files = {"d.comp"}}),
              AllOf(HasSubstr("d.comp:2"), HasSubstr("lib2/nowhere.glsl"), HasSubstr(dir().path())));
  EXPECT_THAT(error_of({.files = {"nothing.comp"}}), HasSubstr("'nothing.comp' not found"));
  EXPECT_THAT(error_of({.files = {"d.glsl"}}), HasSubstr("names no stage"));
}

TEST_F(ProgramTest, AFileThatIncludesItselfIsAnError) {
  write_shader("lib2/loop.glsl", "#include \"lib2/loop.glsl\"\n");
  write_shader("e.comp", "#include \"lib2/loop.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
  EXPECT_THAT(error_of({.files = {"e.comp"}}), HasSubstr("includes itself"));
}

TEST_F(ProgramTest, PragmaOnceGuards) {
  write_shader("lib2/once.glsl", "#pragma once\nfloat f() { return 1.; }\n");
  write_shader(
      "f.comp",
      "#include \"lib2/once.glsl\"\n#include \"lib2/once.glsl\"\nlayout(local_size_x = 1) in;\nvoid main() { f(); }\n");
  EXPECT_EQ(error_of({.files = {"f.comp"}}), "no error");
}

TEST_F(ProgramTest, AFailedLinkIsReported) {
  write_shader("g.vert", "out vec3 given;\nvoid main() { given = vec3(1); gl_Position = vec4(0); }\n");
  write_shader("g.frag", "in vec4 given;\nout vec4 color;\nvoid main() { color = given; }\n");
  EXPECT_THAT(error_of({.files = {"g.vert", "g.frag"}}), AllOf(HasSubstr("shader-link"), HasSubstr("g.vert + g.frag")));
}

TEST_F(ProgramTest, InteropHeadersAreGlsl) {
  for (const char* header : {"camera", "frame", "light", "scene"}) {
    write_shader("h.comp",
                 std::string("#include \"interop/") + header + ".h\"\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
    EXPECT_EQ(error_of({.files = {"h.comp"}}), "no error") << header;
  }
}

TEST_F(ProgramTest, UnitsAndBindingsAreGivenOutByName) {
  write_shader("i.comp", R"(
layout(local_size_x = 1) in;
uniform sampler2D a;
uniform sampler3D b;
uniform sampler2DArrayShadow c;
layout(rgba32f) uniform image2D out_a;
layout(r32ui) uniform uimage3D out_b;
layout(std140) uniform one { vec4 x; } first;
layout(std140) uniform two { vec4 x; } second;
void main() {
  imageStore(out_a, ivec2(0), texture(a, vec2(0)) + texture(b, vec3(0)) + texture(c, vec4(0)) + first.x + second.x);
  imageAtomicAdd(out_b, ivec3(0), 1u);
}
)");
  const auto program = make_device()->program({.files = {"i.comp"}});
  const auto distinct = [](const std::vector<ProgramInterface::Resource>& resources, std::size_t count) {
    EXPECT_EQ(resources.size(), count);
    std::set<int> seen;
    for (const auto& resource : resources) seen.insert(resource.location_or_binding);
    EXPECT_EQ(seen.size(), count);
  };
  distinct(program->interface().samplers, 3);
  distinct(program->interface().images, 2);
  distinct(program->interface().uniform_blocks, 2);
  EXPECT_TRUE(program->interface().uniforms.empty());
}

class ProgramCacheTest : public ProgramTest {
 protected:
  [[nodiscard]] std::string cache() const { return dir() / "cache"; }
  [[nodiscard]] gpu::ProgramStats start(const std::string& offset = "5") const {
    const auto device = make_device(cache());
    device->program({.files = {"a.comp"}, .defines = {{"OFFSET", offset}}});
    return device->stats();
  }
  [[nodiscard]] std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(cache())) found.push_back(entry.path());
    return found;
  }
};

TEST_F(ProgramCacheTest, ASecondStartCompilesNothing) {
  write_shader("a.comp", simple);
  EXPECT_EQ(start().compiled, 1);
  ASSERT_EQ(files().size(), 1u) << "this driver gives no program binaries";
  const gpu::ProgramStats again = start();
  EXPECT_EQ(again.compiled, 0);
  EXPECT_EQ(again.from_disk, 1);
}

TEST_F(ProgramCacheTest, WhatChangedIsCompiled) {
  write_shader("a.comp", std::string("#include \"part.glsl\"\n") + simple);
  write_shader("part.glsl", "const int part = 1;\n");
  EXPECT_EQ(start().compiled, 1);
  EXPECT_EQ(start("6").compiled, 1) << "another define";
  write_shader("part.glsl", "const int part = 2;\n");
  EXPECT_EQ(start().compiled, 1) << "another text of an include";
}

TEST_F(ProgramCacheTest, DamagedFilesAreIgnoredAndReplaced) {
  write_shader("a.comp", simple);
  EXPECT_EQ(start().compiled, 1);
  ASSERT_EQ(files().size(), 1u);
  const auto file = files().front();
  const auto size = std::filesystem::file_size(file);
  for (const std::uintmax_t cut : {std::uintmax_t{0}, std::uintmax_t{10}, size / 2, size - 1}) {
    std::filesystem::resize_file(file, cut);
    EXPECT_EQ(start().compiled, 1) << cut;
    EXPECT_EQ(start().from_disk, 1);
  }
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(size - 5));
    stream.put('!');
    stream.put('?');
  }
  EXPECT_EQ(start().compiled, 1) << "two flipped bytes";
}

TEST_F(ProgramCacheTest, AFolderThatCannotBeMadeIsNoFailure) {
  write_shader("a.comp", simple);
  const std::string file = dir().write("occupied", "");
  const auto device = make_device(file + "/cache");
  device->program({.files = {"a.comp"}, .defines = {{"OFFSET", "1"}}});
  EXPECT_EQ(device->stats().compiled, 1);
}

TEST_F(ProgramCacheTest, InvalidatingASourceCompilesAgain) {
  write_shader("a.comp", std::string("#include \"part.glsl\"\n") + simple);
  write_shader("part.glsl", "const int part = 1;\n");
  const ProgramDesc desc{.files = {"a.comp"}, .defines = {{"OFFSET", "1"}}};
  const auto device = make_device();
  const auto first = device->program(desc);
  EXPECT_THAT(device->sources_of(*first), Contains(EndsWith("part.glsl")));
  device->invalidate(dir() / "other.glsl");
  EXPECT_EQ(device->program(desc), first);
  device->invalidate(dir() / "part.glsl");
  EXPECT_NE(device->program(desc), first);
}

TEST(ShaderLog, NamesFilesForEveryDriver) {
  const std::vector<std::string> files{"main.comp", "lib/math.glsl"};
  EXPECT_EQ(gpu::name_files("1:12(7): error: boo\n", files), "lib/math.glsl:12:7: error: boo");
  EXPECT_EQ(gpu::name_files("1(12) : error C1008: boo", files), "lib/math.glsl:12: error C1008: boo");
  EXPECT_EQ(gpu::name_files("ERROR: 0:12: boo", files), "main.comp:12: ERROR: boo");
  EXPECT_EQ(gpu::name_files("nothing to see", files), "nothing to see");
  EXPECT_EQ(gpu::name_files("9:12(7): error: boo", files), "9:12(7): error: boo") << "no such file";
}

}  // namespace
}  // namespace loom
