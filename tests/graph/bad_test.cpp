// Every file of tests/graph/bad must give exactly the diagnostics that stand in its .expect file. Lines there that
// start with `--` are options of the command line: `--set p.x=v`, `--output name`. With LOOM_UPDATE_EXPECTED=1 the
// files are written instead; read what they say before keeping it.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "graph/fakes.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

const fs::path folder = fs::path(LOOM_SOURCE_DIR) / "tests/graph/bad";

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Parts that other cases extend; they are no cases of their own.
bool is_part(const std::string& name) { return name == "extends_loop_b" || name == "extends_base"; }

std::vector<std::string> cases() {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().stem().string());
  std::vector<std::string> list;
  std::copy_if(names.begin(), names.end(), std::back_inserter(list), [](const auto& name) { return !is_part(name); });
  return list;
}

struct Expectation {
  std::string option_lines;
  graph::CompileOptions options;
  std::string diagnostics;
};

Expectation expectation(const fs::path& path) {
  Expectation expected;
  std::istringstream lines(content(path));
  static const std::regex set(R"(--set (\w+)\.(\w+)=(.*))");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.find("error[") == std::string::npos && std::regex_match(line, match, set))
      expected.options.overrides.push_back({match[1], match[2], match[3]});
    else if (line.starts_with("--output "))
      expected.options.requested.push_back(line.substr(9));
    else
      match = {};
    (match.empty() && !line.starts_with("--output ") ? expected.diagnostics : expected.option_lines) += line + '\n';
  }
  return expected;
}

class BadPipeline : public testing::TestWithParam<std::string> {};

TEST_P(BadPipeline, GivesExactlyItsDiagnostics) {
  static const Registry registry = fake_registry();
  const fs::path expect_path = folder / (GetParam() + ".expect");
  const Expectation expected = expectation(expect_path);
  const auto result =
      graph::compile_file((folder / (GetParam() + ".json")).string(), registry, one_light(), expected.options);
  EXPECT_FALSE(result.graph.has_value());
  EXPECT_TRUE(result.diagnostics.has_errors());
  std::string given = text_of(result.diagnostics);
  for (std::size_t at = 0; (at = given.find(folder.string() + '/', at)) != std::string::npos;)
    given.erase(at, folder.string().size() + 1);
  if (std::getenv("LOOM_UPDATE_EXPECTED") != nullptr)
    std::ofstream(expect_path) << expected.option_lines << given;
  else
    EXPECT_EQ(given, expected.diagnostics);
}

INSTANTIATE_TEST_SUITE_P(Files, BadPipeline, testing::ValuesIn(cases()),
                         [](const auto& instance) { return instance.param; });

TEST(BadPipelines, EveryCodeThatTheCompilerCanGiveHasAFile) {
  // What no pipeline file can show by itself, or only at length: see unit.Json.*, graph.Plan.AnExternalInput* and
  // graph.Limits.*.
  std::set<std::string> shown = {"file-too-large", "file-unreadable", "input-mismatch", "too-many-passes"};
  const std::regex rendered(R"(error\[([a-z0-9-]+)\])");
  for (const auto& name : cases()) {
    const std::string text = content(folder / (name + ".expect"));
    for (std::sregex_iterator it(text.begin(), text.end(), rendered), end; it != end; ++it) shown.insert((*it)[1]);
  }
  const fs::path framework = fs::path(LOOM_SOURCE_DIR) / "framework";
  std::vector<fs::path> sources = {framework / "core/json.cpp", framework / "core/params.cpp"};
  for (const auto& entry : fs::directory_iterator(framework / "graph/compile")) sources.push_back(entry.path());
  const std::regex emitted(R"((?:error|warning)\(\s*"([a-z0-9-]+)\"\s*,)");
  std::set<std::string> codes;
  for (const auto& source : sources) {
    const std::string text = content(source);
    for (std::sregex_iterator it(text.begin(), text.end(), emitted), end; it != end; ++it) codes.insert((*it)[1]);
  }
  EXPECT_GT(codes.size(), 40U) << "the pattern no longer finds the codes in the sources";
  for (const auto& code : codes) EXPECT_TRUE(shown.contains(code)) << "no file in tests/graph/bad gives " << code;
}

}  // namespace
}  // namespace loom::test
