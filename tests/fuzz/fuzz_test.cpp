// Every file of the corpus, whole and damaged: an answer, never a crash. The damage is the same in every run; clang's
// libFuzzer looks further (docs/stability.md has the command).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/targets.h"

namespace loom::fuzz {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// "words" of a libFuzzer dictionary, one a line, in quotes; \xNN is a byte.
std::vector<std::string> dictionary(std::string_view name) {
  std::vector<std::string> words;
  std::ifstream in(fs::path(LOOM_SOURCE_DIR) / "tests/fuzz/dictionaries" / (std::string(name) + ".dict"));
  for (std::string line; std::getline(in, line);) {
    if (line.size() < 2 || line.front() != '"') continue;
    std::string word;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (line[i] == '\\' && line[i + 1] == 'x') {
        word += static_cast<char>(std::strtol(line.substr(i + 2, 2).c_str(), nullptr, 16));
        i += 3;
      } else if (line[i] == '\\') {
        word += line[++i];
      } else {
        word += line[i];
      }
    }
    words.push_back(word);
  }
  return words;
}

/// A few bytes changed, a piece cut out or said twice, a word put in, the end lost.
std::string damaged(std::string text, const std::vector<std::string>& words, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t change = 0; change <= below(4); ++change) {
    const std::size_t at = below(text.size());
    const std::size_t length = below(std::min<std::size_t>(text.size() - at, 64));
    switch (below(5)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      case 3:
        if (!words.empty()) text.replace(at, below(2) * length, words[below(words.size())]);
        break;
      default:
        if (below(8) == 0) text.resize(at);
    }
  }
  return text;
}

class Fuzz : public testing::TestWithParam<Target> {};

TEST_P(Fuzz, EveryFileOfTheCorpusWholeAndDamaged) {
  const Target& target = GetParam();
  const std::vector<std::string> words = dictionary(target.name);
  EXPECT_FALSE(words.empty());
  std::mt19937 random(1);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(LOOM_SOURCE_DIR) / "tests/fuzz/corpus" / target.name)) {
    ++files;
    const std::string text = content(entry.path());
    SCOPED_TRACE(entry.path().filename().string());
    EXPECT_NO_THROW(target.run(std::as_bytes(std::span(text))));
    for (int round = 0; round < 100; ++round) {
      const std::string other = damaged(text, words, random);
      EXPECT_NO_THROW(target.run(std::as_bytes(std::span(other)))) << "round " << round;
    }
  }
  EXPECT_GT(files, 1u);
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, testing::ValuesIn(targets),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace loom::fuzz
