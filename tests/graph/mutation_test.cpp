// Whatever a file holds, the compiler ends in a plan or in diagnostics that say where.
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "graph/fakes.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> texts() {
  std::vector<std::string> list;
  const fs::path folder = fs::path(LOOM_SOURCE_DIR) / "tests/graph";
  for (const char* name : {"golden/temporal.json", "bad/everything_at_once.json", "bad/in_place_cycle.json",
                           "bad/unknown_format.json", "bad/param_type.json"}) {
    std::ifstream file(folder / name);
    std::ostringstream text;
    text << file.rdbuf();
    list.push_back(text.str());
  }
  return list;
}

void expect_an_answer(const std::string& text) {
  static const Registry registry = fake_registry();
  const auto result = compile(text, registry);
  EXPECT_NE(result.graph.has_value(), result.diagnostics.has_errors()) << text;
  for (const auto& diagnostic : result.diagnostics.all()) {
    EXPECT_FALSE(diagnostic.code.empty()) << text;
    EXPECT_FALSE(diagnostic.message.empty()) << text;
    EXPECT_GT(diagnostic.where.line, 0) << text << to_string(diagnostic);
    EXPECT_GT(diagnostic.where.column, 0) << text << to_string(diagnostic);
  }
}

TEST(Mutations, OfBytes) {
  std::mt19937 random(1);
  const auto originals = texts();
  for (int i = 0; i < 3000; ++i) {
    std::string text = originals[random() % originals.size()];
    for (unsigned n = random() % 4 + 1; n > 0; --n) {
      const std::size_t place = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[place] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(place, random() % 8 + 1);
          break;
        default:
          text.insert(place, 1, "{}[]\",:0-e.@"[random() % 12]);
      }
      if (text.empty()) text = " ";
    }
    expect_an_answer(text);
  }
}

/// Well-formed files with wrong contents: strings and numbers change places.
TEST(Mutations, OfTokens) {
  std::mt19937 random(2);
  const auto originals = texts();
  constexpr std::array<std::string_view, 22> tokens = {"\"image\"",
                                                       "\"taa.image\"",
                                                       "\"taa.image@prev\"",
                                                       "\"copy.image\"",
                                                       "\"shade.irradiance\"",
                                                       "\"inputs.env\"",
                                                       "\"type\"",
                                                       "\"in\"",
                                                       "\"Brighten\"",
                                                       "\"Accumulate\"",
                                                       "\"Filter\"",
                                                       "\"Pass\"",
                                                       "\"Volume\"",
                                                       "\"Debug\"",
                                                       "\"Tuned\"",
                                                       "\"passes\"",
                                                       "\"NeverSettles\"",
                                                       "null",
                                                       "-1",
                                                       "{}",
                                                       "[[1e308, true]]",
                                                       "\"show.image\""};
  for (int i = 0; i < 3000; ++i) {
    std::string text = originals[random() % originals.size()];
    for (unsigned n = random() % 4 + 1; n > 0; --n) {
      std::vector<std::pair<std::size_t, std::size_t>> strings;
      for (std::size_t at = text.find('"'); at != std::string::npos;) {
        const std::size_t end = text.find('"', at + 1);
        if (end == std::string::npos) break;
        strings.emplace_back(at, end - at + 1);
        at = text.find('"', end + 1);
      }
      const auto [place, length] = strings[random() % strings.size()];
      text.replace(place, length, tokens[random() % tokens.size()]);
    }
    expect_an_answer(text);
  }
}

}  // namespace
}  // namespace loom::test
