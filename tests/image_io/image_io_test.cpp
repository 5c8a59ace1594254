// PNG and EXR: what is written is what is read, and damaged files are errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "core/srgb.h"
#include "loom/diagnostic.h"

namespace loom {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageIo : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) /
           (std::string("loom_image_io_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(dir_), fs::directory_iterator()));
  }
  static std::vector<char> bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write_bytes(const std::string& file, const std::vector<char>& bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  static ImageLayers some_layers() {
    ImageLayers image{.width = 3, .height = 2, .channels = {}, .attributes = {{"loom:quantity", "irradiance"}}};
    image.channels["R"] = {0.f, 1.f, 1e-20f, 65504.f, 1e30f, -3.5f};
    image.channels["direct.G"] = {1.f, 2.f, 3.f, 4.f, 5.f, 6.f};
    image.channels["depth.Z"] = {std::numeric_limits<float>::infinity(), .1f, 0.f, -0.f, 7.f, 8.f};
    return image;
  }

  fs::path dir_;
};

TEST_F(ImageIo, ExrGivesBackEveryBit) {
  const ImageLayers written = some_layers();
  write_exr(path("a.exr"), written);
  const ImageLayers read = read_exr(path("a.exr"));
  EXPECT_EQ(read.width, 3);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.channels, written.channels);
  EXPECT_EQ(read.attributes.at("loom:quantity"), "irradiance");
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageIo, ExrKeepsNaN) {
  ImageLayers image{.width = 1, .height = 1, .channels = {}, .attributes = {}};
  image.channels["R"] = {std::numeric_limits<float>::quiet_NaN()};
  write_exr(path("nan.exr"), image);
  EXPECT_TRUE(std::isnan(read_exr(path("nan.exr")).channels.at("R").front()));
}

TEST_F(ImageIo, PngRoundsToTheNearestCode) {
  // Half a code below and above code 100, and what does not fit 8 bits.
  const std::vector<glm::vec3> display = {{99.6f / 255, 100.4f / 255, 1.f},
                                          {-1.f, 2.f, std::numeric_limits<float>::quiet_NaN()}};
  write_png(path("a.png"), 2, 1, display);
  const ImageLayers read = read_png(path("a.png"));
  ASSERT_EQ(read.width, 2);
  ASSERT_EQ(read.height, 1);
  const float code_100 = srgb_to_linear(100.f / 255);
  EXPECT_FLOAT_EQ(read.channels.at("R")[0], code_100);
  EXPECT_FLOAT_EQ(read.channels.at("G")[0], code_100);
  EXPECT_FLOAT_EQ(read.channels.at("B")[0], 1.f);
  EXPECT_FLOAT_EQ(read.channels.at("R")[1], 0.f);
  EXPECT_FLOAT_EQ(read.channels.at("G")[1], 1.f);
  EXPECT_FLOAT_EQ(read.channels.at("B")[1], 0.f);
}

TEST_F(ImageIo, PngKeepsAllCodes) {
  std::vector<glm::vec3> display;
  for (int code = 0; code < 256; ++code) display.emplace_back(static_cast<float>(code) / 255.f);
  write_png(path("ramp.png"), 16, 16, display);
  const ImageLayers read = read_png(path("ramp.png"));
  for (std::size_t code = 0; code < 256; ++code) {
    EXPECT_EQ(std::lround(255.f * linear_to_srgb(read.channels.at("G")[code])), static_cast<long>(code));
  }
}

TEST_F(ImageIo, SrgbCurvesAreInverse) {
  for (double linear = 0; linear <= 1; linear += 1. / 512) {
    EXPECT_NEAR(srgb_to_linear(linear_to_srgb(linear)), linear, 1e-7);
  }
  EXPECT_NEAR(srgb_to_linear(.5), .21404114, 1e-8);  // IEC 61966-2-1
}

TEST_F(ImageIo, TruncatedFilesAreBadInput) {
  write_exr(path("good.exr"), some_layers());
  write_png(path("good.png"), 2, 1, std::vector<glm::vec3>(2, glm::vec3(.5f)));
  for (const std::string name : {"good.exr", "good.png"}) {
    const std::vector<char> whole = bytes_of(path(name));
    for (std::size_t keep = 0; keep + 13 < whole.size(); keep += 7) {
      write_bytes(path("cut"), {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(keep)});
      if (name == "good.exr") {
        EXPECT_THROW((void)read_exr(path("cut")), BadInput) << name << " cut to " << keep;
      } else {
        EXPECT_THROW((void)read_png(path("cut")), BadInput) << name << " cut to " << keep;
      }
    }
  }
}

TEST_F(ImageIo, FlippedBytesNeverCrash) {
  write_exr(path("good.exr"), some_layers());
  write_png(path("good.png"), 2, 1, std::vector<glm::vec3>(2, glm::vec3(.5f)));
  for (const std::string name : {"good.exr", "good.png"}) {
    const std::vector<char> whole = bytes_of(path(name));
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::vector<char> bad = whole;
      bad[at] = static_cast<char>(~bad[at]);
      write_bytes(path("bad"), bad);
      try {
        (void)(name == "good.exr" ? read_exr(path("bad")) : read_png(path("bad")));
      } catch (const BadInput&) {  // an error or a picture; anything else ends the test
      }
    }
  }
}

TEST_F(ImageIo, MissingEmptyAndForeignFilesAreNamed) {
  write_bytes(path("empty"), {});
  write_bytes(path("text"), {'h', 'e', 'l', 'l', 'o'});
  for (const std::string name : {"missing", "empty", "text", ""}) {
    for (const auto read : {&read_exr, &read_png}) {
      try {
        (void)read(path(name));
        ADD_FAILURE() << "read " << name;
      } catch (const BadInput& error) {
        EXPECT_THAT(error.what(), HasSubstr(path(name)));
        EXPECT_EQ(error.diagnostics().all().front().code, "bad-image");
      }
    }
  }
}

TEST_F(ImageIo, FailedWritesLeaveNothing) {
  EXPECT_THROW(write_exr(path("no/such/folder.exr"), some_layers()), Error);
  EXPECT_THROW(write_png(path("no/such/folder.png"), 1, 1, std::vector<glm::vec3>(1)), Error);
  ImageLayers ragged = some_layers();
  ragged.channels["G"] = {1.f};
  EXPECT_THROW(write_exr(path("ragged.exr"), ragged), Error);
  EXPECT_THROW(write_exr(path("none.exr"), {}), Error);
  EXPECT_THROW(write_png(path("short.png"), 2, 2, std::vector<glm::vec3>(3)), Error);
  fs::create_directory(dir_ / "folder");
  EXPECT_THROW(write_file_atomic(path("folder"), {}), Error);
  EXPECT_EQ(files(), 1u);  // the folder
}

TEST_F(ImageIo, WritingReplacesTheOldFile) {
  const std::string text = "new";
  write_bytes(path("file"), {'o', 'l', 'd', '!', '!'});
  write_file_atomic(path("file"), std::as_bytes(std::span(text)));
  EXPECT_EQ(bytes_of(path("file")), (std::vector<char>{'n', 'e', 'w'}));
  EXPECT_EQ(files(), 1u);
}

TEST_F(ImageIo, TakesNoMemoryOnAFilesWord) {
  ImageLayers image{.width = 4, .height = 4, .channels = {}, .attributes = {}};
  for (const char* channel : {"R", "G", "B"}) image.channels[channel].assign(16, .5F);
  const std::string name = path("claims.exr");
  write_exr(name, image);
  std::fstream file(name, std::ios::in | std::ios::out | std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  // name, type and size of the attribute, then xMin, yMin, xMax, yMax
  const std::size_t window = text.find("dataWindow") + 11 + 6 + 4;
  const std::int32_t last = (1 << 22) - 1;
  file.seekp(static_cast<std::streamoff>(window + 8));
  file.write(reinterpret_cast<const char*>(&last), sizeof(last));
  file.close();
  try {
    (void)read_exr(name);
    FAIL() << "it was read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("claims 4194304x4"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace loom
