// What a glTF file may read: its own folder, and more only where that is allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/load.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

/// A triangle whose corners lie in the file that `uri` names.
std::string triangle(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
         uri + R"("}]})";
}

/// The same, coloured by an image.
std::string textured(const std::string& uri) {
  return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
    "images":[{"uri":")" +
         uri + R"("}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"corners.bin"}]})";
}

/// A scene's folder, with another beside it that is not the scene's.
class Outside : public testing::Test {
 protected:
  void SetUp() override {
    const std::vector<float> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::string bytes(reinterpret_cast<const char*>(corners.data()), corners.size() * sizeof(float));
    for (const char* file : {"scene/corners.bin", "scene/below/corners.bin", "scene/a b.bin", "other/corners.bin"})
      (void)dir_.write(file, bytes);
    fs::create_symlink(dir_ / "other/corners.bin", dir_ / "scene/leads-out.bin");
    fs::create_directory_symlink(dir_ / "other", dir_ / "scene/folder-out");
    fs::create_symlink("below/corners.bin", dir_ / "scene/leads-below.bin");
    fs::create_symlink("circle.bin", dir_ / "scene/circle.bin");
    fs::create_directory_symlink(dir_ / "scene", dir_ / "by-another-name");
  }
  /// Empty where the scene loads, else what is said.
  [[nodiscard]] std::string load(const std::string& text, bool allow, const std::string& folder = "scene") const {
    Diagnostics diagnostics;
    try {
      const scene::Scene scene =
          scene::load_gltf(dir_.write(folder + "/x.gltf", text), diagnostics, {.allow_outside = allow});
      return compute_facts(scene).triangles == 1u ? "" : "no triangle";
    } catch (const BadInput& error) {
      return error.what();
    }
  }
  TempDir dir_;
};

TEST_F(Outside, WhatStaysInTheFolderNeedsNoLeave) {
  for (const char* uri : {"corners.bin", "./corners.bin", "below/corners.bin", "a%20b.bin", "%63orners.bin",
                          "below%2fcorners.bin", "leads-below.bin"}) {
    EXPECT_EQ(load(triangle(uri), false), "") << uri;
    EXPECT_EQ(load(triangle(uri), true), "") << uri;
  }
  EXPECT_EQ(load(triangle("corners.bin"), false, "by-another-name"), "") << "the folder itself may be a link";
}

TEST_F(Outside, WhatLeavesItDoes) {
  const std::string absolute = dir_ / "other/corners.bin";
  for (const std::string& uri : {std::string("../other/corners.bin"), std::string("below/../../other/corners.bin"),
                                 std::string("%2e%2e/other/corners.bin"), std::string("..%2Fother%2fcorners.bin"),
                                 std::string("leads-out.bin"), std::string("folder-out/corners.bin"),
                                 std::string("%66older-out/corners.bin"), absolute, "%2f" + absolute.substr(1)}) {
    const std::string refused = load(triangle(uri), false);
    EXPECT_THAT(refused, testing::HasSubstr("gltf-uri")) << uri;
    EXPECT_THAT(refused, testing::HasSubstr("--allow-outside")) << uri;
    EXPECT_EQ(load(triangle(uri), true), "") << uri;
  }
}

TEST_F(Outside, AnImageIsHeldToTheSame) {
  // That it is no image is said once it has been read.
  const std::string secret = dir_.write("other/secret.png", "no image");
  fs::create_symlink(secret, dir_ / "scene/link.png");
  for (const char* uri : {"../other/secret.png", "%2e%2e/other/secret.png", "link.png"}) {
    EXPECT_THAT(load(textured(uri), false), testing::HasSubstr("gltf-uri")) << uri;
    EXPECT_EQ(load(textured(uri), true), "") << uri << ": a texture that cannot be read is a warning";
  }
}

TEST_F(Outside, SomeNamesAreNoFilesWhateverIsAllowed) {
  for (const char* uri : {"http://example.org/corners.bin", "file:///etc/passwd", "%66ile:corners.bin",
                          "corners%00.bin", "corners%2.bin", "..%5cother%5ccorners.bin"}) {
    for (const bool allow : {false, true}) {
      EXPECT_THAT(load(triangle(uri), allow), testing::HasSubstr("gltf-uri")) << uri;
    }
  }
  EXPECT_NE(load(triangle("circle.bin"), false), "");
  EXPECT_NE(load(triangle("circle.bin"), true), "");
  EXPECT_THAT(load(triangle("below"), true), testing::HasSubstr("no regular file"));
}

}  // namespace
}  // namespace loom::test
