// What a pass author does: install Lightloom, move the installation, write a pass, build it against the installation,
// render with it. Nothing of Lightloom is rebuilt.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

/// Fails with what was said where the exit code is not 0.
ProcessResult run(const std::string& program, const std::vector<std::string>& arguments) {
  ProcessResult result = run_process(program, arguments);
  EXPECT_EQ(result.exit_code, 0) << program << " " << testing::PrintToString(arguments) << "\n"
                                 << result.out << result.err;
  return result;
}

TEST(NewPass, BuildsAgainstAMovedInstallationAndRuns) {
  for (const char* name : {"LOOM_PLUGIN_PATH", "LOOM_SHADER_PATH", "LOOM_DATA_DIR", "DESTDIR"}) unsetenv(name);
  const TempDir dir;
  run(CMAKE_COMMAND, {"--install", LOOM_BINARY_DIR, "--prefix", dir / "prefix"});
  fs::rename(dir / "prefix", dir / "moved");
  const std::string loom = dir / "moved/bin/loom";

  run("/bin/sh", {"-c", "cd '" + dir.path() + "' && '" + loom + "' new-pass Example"});
  run(CMAKE_COMMAND,
      {"-G", "Ninja", "-S", dir / "example", "-B", dir / "example/build", "-DCMAKE_PREFIX_PATH=" + (dir / "moved"),
       std::string("-DCMAKE_CXX_COMPILER=") + CMAKE_CXX_COMPILER, std::string("-DCMAKE_CXX_FLAGS=") + PASS_FLAGS});
  run(CMAKE_COMMAND, {"--build", dir / "example/build"});

  const std::vector<std::string> common = {"-p", dir / "example/example.json", "--plugins", dir / "example/build"};
  const auto render = [&](const std::string& out, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"render", "--size", "32x32", "-o", out};
    arguments.insert(arguments.end(), common.begin(), common.end());
    arguments.insert(arguments.end(), options.begin(), options.end());
    run(loom, arguments);
    return read_png(out);
  };
  // brightness · ⟨n, v⟩ in linear light. A pixel of the back wall, which the camera faces: 7.5 of 16 half-heights above
  // the middle, so that cos = 1/√(1 + (tan(yfov/2)·7.5/16)² + (tan(yfov/2)·.5/16)²) with yfov = .686048.
  const double t = std::tan(.686048 / 2);
  const double cosine = 1 / std::sqrt(1 + std::pow(t * 7.5 / 16, 2) + std::pow(t * .5 / 16, 2));
  constexpr std::size_t pixel = 8 * 32 + 16;
  // 8-bit sRGB codes are at most .009 apart in linear light.
  EXPECT_NEAR(render(dir / "a.png", {}).channels.at("G")[pixel], cosine, .0045);
  EXPECT_NEAR(render(dir / "half.png", {"--set", "example.brightness=.5"}).channels.at("G")[pixel], cosine / 2, .0045);
  const ImageLayers black = render(dir / "black.png", {"--set", "example.brightness=0"});
  EXPECT_THAT(black.channels.at("G"), testing::Each(0.f));

  // The other passes of the installation are there, and the program runs with none of the build tree's files.
  EXPECT_THAT(run(loom, {"passes"}).out, testing::HasSubstr("Tonemap"));
  EXPECT_THAT(run(loom, {"passes", "Example", "--plugins", dir / "example/build"}).out,
              testing::HasSubstr("brightness"));
  EXPECT_THAT(run("/usr/bin/ldd", {loom}).out, testing::HasSubstr(dir / "moved"));
}

}  // namespace
}  // namespace loom::test
