#pragma once
// The program as its users see it: a folder to write into, exit codes, what stands on stdout and stderr.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {

using Json = nlohmann::ordered_json;

class Cli : public testing::Test {
 protected:
  /// Small enough for any machine; options follow.
  static std::vector<std::string> render(const std::string& pipeline, const std::string& out,
                                         const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {"render", "-p", pipeline, "-o", out, "--size", "32x24"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  }
  std::string path(const std::string& name) const { return dir_ / name; }
  /// Names of what lies in the folder, sorted.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(dir_.path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  static std::string text_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static std::vector<std::string> keys(const Json& object) {
    std::vector<std::string> names;
    for (const auto& [key, value] : object.items()) names.push_back(key);
    return names;
  }
  /// Fails the test, with what was said, where the exit code is another.
  static ProcessResult expect(int exit_code, const std::vector<std::string>& arguments) {
    ProcessResult result = run_loom(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << testing::PrintToString(arguments) << "\n" << result.err;
    return result;
  }

  TempDir dir_;
};

}  // namespace loom::test
