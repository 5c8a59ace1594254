// Runs that are cut off, disks that are full, processes that share a cache.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/image_io.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

const std::string loom = LOOM_BINARY_DIR "/bin/loom";

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Kills the command `times` times, each somewhere within the time that a whole run takes (seeded). What it writes is
/// absent or what the whole run wrote; where `resumes`, it may also be a step on the way there. The run after that
/// writes the same bits.
void kill_at_random(const std::vector<std::string>& command, const std::string& name, int times, bool resumes) {
  const TempDir dir;
  const auto arguments_for = [&](const std::string& file) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"-o", dir / file});
    return arguments;
  };
  (void)run_loom(arguments_for("warm-" + name));
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_loom(arguments_for("whole-" + name)).exit_code, 0);
  const std::chrono::duration<double> whole_run = std::chrono::steady_clock::now() - start;
  const std::string whole = content(dir / ("whole-" + name));
  ASSERT_FALSE(whole.empty());

  std::mt19937 random(7);
  std::uniform_real_distribution<double> moment(.02, 1);
  const std::string target = dir / name;
  int killed = 0;
  for (int i = 0; i < times; ++i) {
    std::vector<std::string> arguments{"-s", "KILL", std::to_string(moment(random) * whole_run.count()), loom};
    const std::vector<std::string> own = arguments_for(name);
    arguments.insert(arguments.end(), own.begin(), own.end());
    killed += run_process("/usr/bin/timeout", arguments).exit_code == 0 ? 0 : 1;
    if (!fs::exists(target)) continue;
    if (!resumes) {
      EXPECT_EQ(content(target), whole) << "after kill " << i;
      fs::remove(target);
    } else {
      EXPECT_EQ(run_loom({"compare", target, dir / ("whole-" + name)}).exit_code, 0) << "after kill " << i;
    }
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(run_loom(arguments_for(name)).exit_code, 0);
  EXPECT_EQ(content(target), whole);
}

/// Everything in the folder is whole: JSON parses, pictures can be read. What was being written is called NAME.part….
void expect_whole_files(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().string();
    const std::string extension = entry.path().extension().string();
    SCOPED_TRACE(path);
    if (extension == ".json") {
      EXPECT_TRUE(nlohmann::json::accept(content(path)));
    } else if (extension == ".exr") {
      EXPECT_NO_THROW((void)read_exr(path));
    } else if (extension == ".png") {
      EXPECT_NO_THROW((void)read_png(path));
    }
  }
}

/// What of a measurement is the same in every run: errors, not times.
std::vector<nlohmann::json> errors_of(const fs::path& points) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(points)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<nlohmann::json> errors;
  for (const fs::path& file : files) errors.push_back(nlohmann::json::parse(content(file)).at("error"));
  return errors;
}

/// Kills a command that measures point by point into `folder`, `times` times, each after a random part of the time that
/// all of it takes; then lets it end. The errors are those of a run that nothing stopped.
void kill_measuring(const std::string& command, int times) {
  const TempDir dir;
  const std::string sweep = dir.write("sweep.json", R"({ "scenes": ["cornell-box"], "size": [16, 16], "samples": 1,
    "frames": 2, "seeds": 1, "reference": { "spp": 256 }, "pipelines": ["direct", { "pipeline": "rsm-denoised",
    "set": { "bounce.samples": [4, 16] } }] })");
  const auto words = [&](const std::string& name) -> std::vector<std::string> {
    const std::string folder = dir / name;
    if (command == "measure") return {"measure", sweep, "-o", folder, "--references", folder + "/refs", "--no-flicker"};
    return {"tune",           "cornell-box",  "--space",        sweep,         "--work", folder,          "-o",
            folder + ".json", "--references", folder + "/refs", "--budget-ms", "1e9",    "--evaluations", "3"};
  };
  const auto start = std::chrono::steady_clock::now();
  const ProcessResult whole = run_loom(words("whole"));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> moment(.02, 1);
  int killed = 0;
  for (int i = 0; i < times; ++i) {
    // Long runs are made of many short ones: from time to time all is made anew.
    if (i % 5 == 0) fs::remove_all(dir / "cut");
    std::vector<std::string> arguments{"-s", "KILL", std::to_string(moment(random) * time.count()), loom};
    for (std::string& word : words("cut")) arguments.push_back(std::move(word));
    killed += run_process("/usr/bin/timeout", arguments).exit_code == 0 ? 0 : 1;
    expect_whole_files(dir.path());
  }
  EXPECT_GT(killed, 0);
  const ProcessResult last = run_loom(words("cut"));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(errors_of(dir / "cut/points"), errors_of(dir / "whole/points"));
}

TEST(Interrupted, AMeasurementGoesOnToTheSameErrors) { kill_measuring("measure", 2); }
TEST(Interrupted, ASearchGoesOnToTheSameErrors) { kill_measuring("tune", 2); }
TEST(SlowInterrupted, AMeasurementGoesOnToTheSameErrorsAHundredTimes) { kill_measuring("measure", 100); }
TEST(SlowInterrupted, ASearchGoesOnToTheSameErrorsAHundredTimes) { kill_measuring("tune", 100); }

const std::vector<std::string> render_command{"render", "-p", "rsm-denoised", "--size", "48x32", "--frames", "4"};
const std::vector<std::string> reference_command{"reference", "--size", "48x32", "--spp", "32", "--seed", "3"};

TEST(Interrupted, ARenderWritesAllOrNothing) { kill_at_random(render_command, "out.exr", 3, false); }
TEST(Interrupted, AReferenceGoesOnToTheSameBits) { kill_at_random(reference_command, "ref.exr", 3, true); }
TEST(SlowInterrupted, ARenderWritesAllOrNothingAHundredTimes) { kill_at_random(render_command, "out.exr", 100, false); }
TEST(SlowInterrupted, AReferenceGoesOnToTheSameBitsAHundredTimes) {
  kill_at_random(reference_command, "ref.exr", 100, true);
}

TEST(Interrupted, AFullDiskIsAClearErrorAndLeavesNothing) {
  const TempDir dir;
  // Files end at 8 blocks, whatever the block is to this shell: far less than the picture.
  const std::string limited = "trap '' XFSZ; ulimit -f 8; exec \"$@\"";
  for (const char* name : {"out.exr", "out.png"}) {
    const ProcessResult result = run_process(
        "/bin/sh", {"-c", limited, "sh", loom, "render", "-p", "direct", "--size", "256x256", "-o", dir / name});
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, testing::HasSubstr("cannot write " + (dir / name)));
    EXPECT_TRUE(fs::is_empty(dir.path())) << name;
  }
}

TEST(Interrupted, AFolderThatTakesNoFilesIsAClearError) {
  const TempDir dir;
  const std::vector<std::string> render{"render", "-p", "direct", "--size", "8x8", "-o"};
  for (const std::string& target : {dir / "absent/out.exr", std::string("/proc/out.exr")}) {
    std::vector<std::string> arguments = render;
    arguments.push_back(target);
    const ProcessResult result = run_loom(arguments);
    EXPECT_NE(result.exit_code, 0) << target;
    EXPECT_LE(result.exit_code, 2) << target;
    EXPECT_THAT(result.err, testing::HasSubstr(target));
  }
}

TEST(Interrupted, ProcessesShareTheCache) {
  const TempDir dir;
  const std::string cache = "XDG_CACHE_HOME=" + (dir / "cache");
  const auto render = [&](int i) {
    return run_process("/usr/bin/env", {cache, loom, "render", "-p", "direct", "--size", "16x12", "-o",
                                        dir / ("out" + std::to_string(i) + ".png")});
  };
  std::vector<std::thread> threads;
  std::vector<ProcessResult> results(4);
  for (int i = 0; i < 3; ++i) threads.emplace_back([&, i] { results[static_cast<std::size_t>(i)] = render(i); });
  for (std::thread& thread : threads) thread.join();
  results[3] = render(3);  // from what the others left
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(results[static_cast<std::size_t>(i)].exit_code, 0) << results[static_cast<std::size_t>(i)].err;
    EXPECT_EQ(content(dir / ("out" + std::to_string(i) + ".png")), content(dir / "out0.png"));
  }
  EXPECT_FALSE(fs::is_empty(dir / "cache/lightloom"));
}

}  // namespace
}  // namespace loom::test
