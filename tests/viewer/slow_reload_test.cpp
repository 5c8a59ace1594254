// Hot reload, a thousand times: the same pictures to the end, and no memory that stays behind.
#include <gtest/gtest.h>
#include <malloc.h>

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/gl.h"
#include "viewer/model.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

/// Bytes in use of the C library's heap: what a software renderer compiles and draws to lies there too.
std::size_t in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

class SlowReload : public GlTest {};

TEST_F(SlowReload, AThousandTimesGoodAndBad) {
  setenv("LOOM_SHADER_PATH", (dir() / "shaders").c_str(), 1);
  setenv("XDG_STATE_HOME", (dir() / "state").c_str(), 1);
  const fs::path shader = fs::path(dir().path()) / "shaders/tonemap/tonemap.comp";
  fs::create_directories(shader.parent_path());
  std::ifstream in(LOOM_SOURCE_DIR "/shaders/tonemap/tonemap.comp");
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  const std::string other = good.substr(0, good.rfind('}')) +
                            "  imageStore(image_image, ivec2(gl_GlobalInvocationID.xy), vec4(0, 1, 0, 1));\n}\n";
  const std::string bad = good + "\nthis is no GLSL\n";
  std::ofstream(shader) << good;
  fs::file_time_type time = fs::last_write_time(shader);

  viewer::Model model({.pipeline = "direct", .set = {{"rsm", "shadow_size", "32"}}, .size = glm::ivec2(24, 16)});
  const auto picture = [&] {
    while (model.frame_due()) model.frame(0);
    return model.live().renderer().read("image").texels;
  };
  const std::vector<glm::vec4> first = picture();
  std::size_t early = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::string& text = i % 4 == 1 ? bad : i % 4 == 2 ? other : good;
    std::ofstream(shader, std::ios::trunc) << text;
    fs::last_write_time(shader, time += std::chrono::seconds(2));
    ASSERT_TRUE(model.poll_files()) << i;
    ASSERT_EQ(model.problem().has_errors(), i % 4 == 1) << i;
    if (i % 4 == 1) continue;
    if (i % 4 == 2) {
      ASSERT_EQ(picture().front(), glm::vec4(0, 1, 0, 1)) << i;
    } else {
      ASSERT_EQ(picture(), first) << i;
    }
    if (i == 300) early = in_use();
  }
  EXPECT_LT(in_use(), early + (8u << 20));
}

}  // namespace
}  // namespace loom::test
