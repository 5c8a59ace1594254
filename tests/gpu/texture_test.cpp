#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <glm/gtc/packing.hpp>
#include <glm/vec4.hpp>

#include "gpu/context.h"
#include "loom/diagnostic.h"
#include "loom/gpu.h"
#include "support/gl.h"

namespace loom {
namespace {

using test::GlTest;
using ::testing::HasSubstr;

constexpr Format all_formats[] = {Format::r8,      Format::rg8,   Format::rgba8,  Format::r16f,     Format::rg16f,
                                  Format::rgba16f, Format::r32f,  Format::rg32f,  Format::rgba32f,  Format::r11g11b10f,
                                  Format::r32i,    Format::r32ui, Format::rg32ui, Format::rgba32ui, Format::depth32f};

int channels(Format format) {
  switch (format) {
    case Format::r8:
    case Format::r16f:
    case Format::r32f:
    case Format::r32i:
    case Format::r32ui:
    case Format::depth32f:
      return 1;
    case Format::rg8:
    case Format::rg16f:
    case Format::rg32f:
    case Format::rg32ui:
      return 2;
    case Format::r11g11b10f:
      return 3;
    default:
      return 4;
  }
}

// A value of channel c of texel i that the format holds exactly.
float exact(Format format, std::size_t i, int c) {
  const auto n = static_cast<float>((i * 4 + static_cast<std::size_t>(c)) % 32);
  if (format == Format::r8 || format == Format::rg8 || format == Format::rgba8) return n / 255;
  if (format == Format::r32i) return 5 - n;
  if (is_integer(format)) return n;
  if (format == Format::depth32f) return n / 32;
  return n / 4;  // 5 bits of mantissa: exact in 10-bit floats too
}

std::vector<std::byte> pack(Format format, const std::vector<glm::vec4>& values) {
  std::vector<std::byte> bytes(values.size() * bytes_per_texel(format));
  std::byte* out = bytes.data();
  const auto put = [&](const auto& value) {
    std::memcpy(out, &value, sizeof(value));
    out += sizeof(value);
  };
  for (const glm::vec4& v : values) {
    if (format == Format::r11g11b10f) {
      put(glm::packF2x11_1x10(glm::vec3(v)));
      continue;
    }
    for (int c = 0; c < channels(format); ++c) {
      const float x = v[c];
      if (is_integer(format))
        put(static_cast<std::int32_t>(x));
      else if (bytes_per_texel(format) == static_cast<std::size_t>(channels(format)))
        put(static_cast<std::uint8_t>(std::lround(x * 255)));
      else if (bytes_per_texel(format) == 2 * static_cast<std::size_t>(channels(format)))
        put(glm::packHalf1x16(x));
      else
        put(x);
    }
  }
  return bytes;
}

class EveryFormat : public GlTest, public ::testing::WithParamInterface<Format> {};

TEST_P(EveryFormat, HoldsWhatIsWritten) {
  const Format format = GetParam();
  std::vector<TextureDesc> shapes{TextureDesc::image({5, 3}, format), TextureDesc::layers({5, 3}, 4, format)};
  if (!is_depth(format)) {  // there are no 3D depth textures
    shapes.push_back({.format = format, .kind = TextureKind::d3, .width = 5, .height = 3, .depth = 4});
  }
  shapes.push_back({.format = format, .kind = TextureKind::cube, .width = 3, .height = 3, .depth = 6});
  shapes.push_back({.format = format, .kind = TextureKind::cube_array, .width = 3, .height = 3, .depth = 12});
  for (const TextureDesc& desc : shapes) {
    SCOPED_TRACE(to_string(desc));
    const auto count = static_cast<std::size_t>(desc.width * desc.height * desc.depth);
    std::vector<glm::vec4> values(count, {0, 0, 0, is_depth(format) || channels(format) < 4 ? 1 : 0});
    for (std::size_t i = 0; i < count; ++i)
      for (int c = 0; c < channels(format); ++c) values[i][c] = exact(format, i, c);
    const Texture texture(desc, "round trip");
    texture.write(pack(format, values));
    const std::vector<glm::vec4> back = texture.read();
    ASSERT_EQ(back.size(), count);
    // n/255 in float32 is the driver's to round.
    for (std::size_t i = 0; i < count; ++i)
      for (int c = 0; c < 4; ++c) EXPECT_FLOAT_EQ(back[i][c], values[i][c]) << i << " " << c;
  }
}

TEST_P(EveryFormat, IsClearedEverywhere) {
  const Format format = GetParam();
  const TextureDesc desc{
      .format = format, .kind = TextureKind::d2_array, .width = 4, .height = 4, .depth = 3, .mips = 3};
  const Texture texture(desc, "cleared");
  glm::vec4 expected(0, 0, 0, 1);
  for (int c = 0; c < channels(format); ++c) expected[c] = 1;
  texture.clear(glm::vec4(1));
  for (int mip = 0; mip < 3; ++mip) {
    const auto texels = texture.read(mip);
    EXPECT_EQ(texels.size(), static_cast<std::size_t>(3 * (4 >> mip) * (4 >> mip)));
    for (const glm::vec4& texel : texels) EXPECT_EQ(texel, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, ::testing::ValuesIn(all_formats),
                         [](const auto& parameter) { return std::string(to_string(parameter.param)); });

using TextureTest = GlTest;

TEST_F(TextureTest, RefusesTheWrongAmountOfTexels) {
  const Texture texture(TextureDesc::image({4, 4}, Format::rgba8), "small");
  const std::vector<std::byte> bytes(63);
  EXPECT_THROW(texture.write(bytes), Error);
}

TEST_F(TextureTest, TooLargeIsAnErrorThatSaysTheLimit) {
  try {
    const Texture texture(TextureDesc::image({1 << 20, 1}, Format::rgba8), "wide");
    FAIL() << "a texture of 2^20 texels a side was made";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'wide'"));
    EXPECT_THAT(error.what(), HasSubstr("does not fit"));
  }
}

TEST_F(TextureTest, BorrowedTexturesAreLeftToTheirOwner) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  { const Texture texture = Texture::borrow(name, TextureDesc::image({1, 1}, Format::rgba8)); }
  EXPECT_TRUE(glIsTexture(name));
  glDeleteTextures(1, &name);
}

TEST_F(TextureTest, ALateDestructorInAnotherContextDeletesNothingThere) {
  std::string why;
  auto texture = std::make_unique<Texture>(TextureDesc::image({1, 1}, Format::rgba8), "mine");
  {
    const gpu::Context other = gpu::Context::headless();
    GLuint theirs = 0;
    do {
      glCreateTextures(GL_TEXTURE_2D, 1, &theirs);
    } while (theirs < texture->name());
    ASSERT_EQ(theirs, texture->name());
    texture.reset();
    EXPECT_TRUE(glIsTexture(theirs));
  }
  // No context at all is current now: the destructor must not touch OpenGL.
  test::shared_context(why);
  auto another = std::make_unique<Texture>(TextureDesc::image({1, 1}, Format::rgba8), "mine");
  { const gpu::Context other = gpu::Context::headless(); }
  another.reset();
}

using BufferTest = GlTest;

TEST_F(BufferTest, HoldsWhatIsWritten) {
  const std::vector<int> numbers{1, 2, 3, 4, 5};
  const Buffer buffer = Buffer::of(std::span(numbers), "numbers");
  std::vector<int> back(5);
  buffer.read(std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, numbers);
  const int nine = 9;
  buffer.write(std::as_bytes(std::span(&nine, 1)), 8);
  buffer.read(std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, (std::vector<int>{1, 2, 9, 4, 5}));
  buffer.clear();
  buffer.read(std::as_writable_bytes(std::span(back)));
  EXPECT_EQ(back, std::vector<int>(5, 0));
}

TEST_F(BufferTest, OddSizesAndNothingAtAll) {
  const std::vector<std::byte> odd{std::byte{1}, std::byte{2}, std::byte{3}};
  const Buffer buffer(odd, "odd");
  std::vector<std::byte> back(3);
  buffer.read(back);
  EXPECT_EQ(back, odd);
  const Buffer empty(std::size_t{0}, "empty");
  EXPECT_EQ(empty.bytes(), 0u);
  EXPECT_NE(empty.name(), 0u);
}

TEST_F(BufferTest, RefusesWhatLiesOutside) {
  const Buffer buffer(std::size_t{8}, "eight");
  std::vector<std::byte> bytes(8);
  EXPECT_THROW(buffer.write(bytes, 4), Error);
  EXPECT_THROW(buffer.read(bytes, 9), Error);
}

}  // namespace
}  // namespace loom
