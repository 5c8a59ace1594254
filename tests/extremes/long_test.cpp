// Sessions that do not end: neither light nor memory may grow, whatever the pipeline.
#include <epoxy/gl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "measure/stress_scenes.h"
#include "scene/load.h"
#include "support/bench.h"
#include "support/gl.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

/// Bytes in use, of the C library's heap: textures of a software renderer lie there too.
std::size_t in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Light bounces without loss and every frame starts from the last one's: nothing may grow, neither light nor memory.
void run_long(Device& device, const std::string& pipeline, int frames, bool keep) {
  const measure::View view = measure::make_room({.albedo = 1, .lights = 2, .lamp = 1});
  Bench bench(device, view.scene);
  bench.look(view.camera);
  BenchOptions options{.size = {8, 6}, .requested = {"hdr"}, .frames = frames / 3};
  options.set = {{"rsm", "size", "32"}, {"rsm", "shadow_size", "64"}};
  options.prune = keep;  // without, every pass runs in every frame
  bench.render(pipeline, options);
  const double early = bench.read("hdr").mean().x;
  const std::size_t before = in_use();
  for (int i = frames / 3; i < frames; ++i) bench.next_frame();
  const double late = bench.read("hdr").mean().x;
  EXPECT_GT(late, 0);
  EXPECT_NEAR(late, early, .02 * early) << pipeline;
  // Timings are kept for some thousand frames.
  EXPECT_LT(in_use(), before + (4u << 20)) << pipeline;
}

class Long : public GlTest, public testing::WithParamInterface<std::string> {};
TEST_P(Long, ThreeHundredFramesDriftAndGrowNowhere) { run_long(*make_device(""), GetParam(), 300, true); }
INSTANTIATE_TEST_SUITE_P(Quick, Long, testing::Values("rsm-denoised.json"),
                         [](const auto& parameter) { return parameter.param.substr(0, 3); });

class SlowLong : public GlTest, public testing::WithParamInterface<std::string> {};
TEST_P(SlowLong, TenThousandFramesDriftAndGrowNowhere) { run_long(*make_device(""), GetParam(), 10000, false); }
INSTANTIATE_TEST_SUITE_P(Ten, SlowLong,
                         testing::Values("direct.json", "area.json", "rsm.json", "rsm-denoised.json", "lpv-fast.json",
                                         "lpv-cascaded-fast.json", "lpv-voxel-fast.json", "ray-march-fast.json",
                                         "ray-march-probes-fast.json", "cone-trace-fast.json",
                                         "radiance-field-fast.json", "radiance-field-voxel-fast.json"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name.substr(0, name.find('.'));
                         });

// Every pipeline that ships, 10,000 frames of each, with every pass in every frame:
//   build/bin/test_extremes --gtest_filter='*SlowSoak*'
// prints a line a pipeline. LOOM_SOAK_FRAMES=n takes others than 10,000 frames; LOOM_SOAK_LOG=file keeps the lines, and
// what has one there with as many frames is not run again.

/// Bytes of all textures that the current context has, as OpenGL says.
std::size_t texture_bytes() {
  std::size_t bytes = 0;
  constexpr GLuint most_names = 1u << 14;
  for (GLuint name = 1; name < most_names; ++name) {
    if (glIsTexture(name) == GL_FALSE) continue;
    const auto value = [&](int level, GLenum what) {
      GLint got = 0;
      glGetTextureLevelParameteriv(name, level, what, &got);
      return static_cast<std::size_t>(std::max(got, 0));
    };
    for (int level = 0; level < 15 && value(level, GL_TEXTURE_WIDTH) > 0; ++level) {
      std::size_t bits = 0;
      for (const GLenum channel : {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE,
                                   GL_TEXTURE_ALPHA_SIZE, GL_TEXTURE_DEPTH_SIZE, GL_TEXTURE_STENCIL_SIZE}) {
        bits += value(level, channel);
      }
      bytes +=
          value(level, GL_TEXTURE_WIDTH) * value(level, GL_TEXTURE_HEIGHT) * value(level, GL_TEXTURE_DEPTH) * bits / 8;
    }
  }
  return bytes;
}

std::size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::vector<std::string> shipped() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(LOOM_SOURCE_DIR "/pipelines")) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Every whole number that a pipeline's passes declare, no larger than 4 where its range has that: small grids, few
/// rays.
std::vector<graph::Override> small_sizes(const std::string& pipeline, const SceneFacts& facts) {
  const auto compiled = graph::compile_file(LOOM_SOURCE_DIR "/pipelines/" + pipeline, all_passes(), facts, {});
  if (!compiled.graph) throw BadInput(compiled.diagnostics);
  std::vector<graph::Override> set;
  for (const graph::CompiledPass& pass : compiled.graph->passes) {
    if (pass.type == "DebugView") continue;  // its numbers choose what is shown
    for (const ParamDecl& decl : pass.params.all()) {
      if (decl.kind != ParamKind::integer || decl.min > 4) continue;
      if (decl.max < 4) continue;
      set.push_back({.pass = pass.name, .param = decl.name, .value = "4"});
    }
  }
  return set;
}

int soak_frames() {
  const char* frames = std::getenv("LOOM_SOAK_FRAMES");
  return frames == nullptr ? 10000 : std::max(300, std::atoi(frames));
}

bool same_bits(const Texels& a, const Texels& b) { return a.values == b.values; }

class SlowSoak : public GlTest, public testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    // Most of a short run is the compilation of programs that draw a few pixels.
    setenv("GALLIVM_PERF", "nopt", 0);
  }
};

TEST_P(SlowSoak, NothingDriftsAndNothingGrows) {
  const std::string& pipeline = GetParam();
  const int frames = soak_frames();
  const char* log = std::getenv("LOOM_SOAK_LOG");
  std::string begin = pipeline;
  begin.resize(std::max<std::size_t>(begin.size() + 1, 36), ' ');
  begin += std::to_string(frames) + " frames";
  if (log != nullptr) {
    std::ifstream lines(log);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(begin)) GTEST_SKIP() << line;
    }
  }
  const auto device = make_device("");
  const measure::View view = measure::make_room({.albedo = .5F, .lights = 2, .lamp = 1});
  Bench bench(*device, view.scene);
  bench.look(view.camera);
  constexpr int early = 100, window = 32;
  bench.render(pipeline, {.size = {16, 16},
                          .set = small_sizes(pipeline, bench.facts()),
                          .requested = {"hdr", "image"},
                          .prune = false,
                          .frames = early});
  const std::string output = bench.absent("hdr") ? "image" : "hdr";
  const Texels first = bench.read(output);
  bench.next_frame();
  const bool still = same_bits(first, bench.read(output));
  const auto mean_of_window = [&] {
    double sum = 0;
    for (int i = 0; i < window; ++i) {
      bench.next_frame();
      const glm::vec4 mean = bench.read(output).mean();
      sum += (mean.r + mean.g + mean.b) / (3 * window);
    }
    return sum;
  };
  const double mean_early = mean_of_window();
  int frame = early + 1 + window;
  for (const int warm = std::max(frame, frames / 4); frame < warm; ++frame) bench.next_frame();
  const std::size_t heap = in_use(), resident = resident_bytes(), textures = texture_bytes();
  for (; frame < frames - window; ++frame) bench.next_frame();
  const double mean_late = mean_of_window();
  const Texels last = bench.read(output);
  const auto growth = [](std::size_t now, std::size_t then) {
    return (static_cast<double>(now) - static_cast<double>(then)) / 1024;
  };
  const double heap_kib = growth(in_use(), heap), resident_kib = growth(resident_bytes(), resident),
               textures_kib = growth(texture_bytes(), textures);
  const bool finite = std::all_of(last.values.begin(), last.values.end(), [](const glm::vec4& v) {
    return std::isfinite(v.r) && std::isfinite(v.g) && std::isfinite(v.b) && std::min({v.r, v.g, v.b}) >= 0;
  });
  const double drift = mean_late / mean_early - 1;
  const char* const light = !still                   ? "new light every frame"
                            : same_bits(first, last) ? "the last frame is the 100th"
                                                     : "STILL, BUT THE LAST FRAME IS NOT THE 100TH";
  char found[256];
  std::snprintf(found, sizeof found,
                ": textures %zu KiB %+.0f, heap %+.0f KiB, resident %+.0f KiB, %s, mean %.4g %+.1e%s", textures / 1024,
                textures_kib, heap_kib, resident_kib, light, mean_early, drift, finite ? "" : ", NOT FINITE");
  const std::string line = begin + found;
  std::printf("%s\n", line.c_str());
  const auto write = [&] {
    if (log != nullptr) std::ofstream(log, std::ios::app) << line << (HasFailure() ? "  FAILED\n" : "\n");
  };
  EXPECT_TRUE(finite);
  EXPECT_EQ(textures_kib, 0);
  EXPECT_LT(heap_kib, 4096);  // timings are kept for some thousand frames
  EXPECT_LT(resident_kib, 16384);
  if (output != "hdr") return write();  // views of data, which may be black
  EXPECT_GT(mean_late, 0);
  EXPECT_TRUE(!still || same_bits(first, last));
  EXPECT_NEAR(mean_late, mean_early, .02 * mean_early);
  write();
}

INSTANTIATE_TEST_SUITE_P(Shipped, SlowSoak, testing::ValuesIn(shipped()), [](const auto& parameter) {
  std::string name = fs::path(parameter.param).stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace loom::test
