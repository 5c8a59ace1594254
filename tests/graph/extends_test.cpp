// Pipelines that vary another: per-key merging, removal, places.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/fakes.h"

namespace loom::test {
namespace {

namespace fs = std::filesystem;

class Extends : public testing::Test {
 protected:
  Extends() : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::create_directories(folder_ / "variants");
    write("base.json", R"({
      "name": "base", "summary": "what it is",
      "passes": {
        "source": { "type": "Source" },
        "tuned": { "type": "Tuned", "in": { "image": "source.image" }, "params": { "iterations": 4, "radius": 2 } },
        "out": { "type": "Filter", "in": { "image": "tuned.image" } }
      },
      "outputs": { "image": "out.image", "hdr": "tuned.image", "indirect": "tuned.image" } })");
  }
  ~Extends() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  graph::CompileResult compile_variant(const std::string& text) const {
    write("variants/v.json", text);
    return graph::compile_file((folder_ / "variants/v.json").string(), registry_, one_light());
  }
  graph::CompiledGraph good(const std::string& text) const {
    auto result = compile_variant(text);
    if (result.graph) return std::move(*result.graph);
    ADD_FAILURE() << text_of(result.diagnostics);
    return {};
  }

  Registry registry_ = fake_registry();
  fs::path folder_;
};

template <class T>
T value(const graph::CompiledGraph& graph, std::string_view name) {
  return std::get<T>(Params::value_of(*graph.pass("tuned")->params.find(name)));
}

TEST_F(Extends, ParametersAndOutputsMergeByKey) {
  const auto graph = good(R"({ "extends": "../base.json", "name": "variant",
    "passes": { "tuned": { "params": { "iterations": 8 } } }, "outputs": { "indirect": null } })");
  EXPECT_EQ(graph.name, "variant");
  EXPECT_EQ(graph.summary, "what it is");
  EXPECT_EQ(value<int>(graph, "iterations"), 8);
  EXPECT_EQ(value<float>(graph, "radius"), 2);
  ASSERT_EQ(graph.outputs.size(), 3U);
  EXPECT_EQ(graph.outputs[0].endpoint, "out.image");
  EXPECT_EQ(graph.outputs[2].name, "indirect");
  EXPECT_TRUE(graph.outputs[2].absent.has_value());
  EXPECT_EQ(graph.files.size(), 2U);
}

TEST_F(Extends, NullTakesAParameterBackToItsDefault) {
  const auto graph = good(R"({ "extends": "../base.json", "passes": { "tuned": { "params": { "radius": null } } } })");
  EXPECT_EQ(value<float>(graph, "radius"), 0.7F);
  EXPECT_EQ(value<int>(graph, "iterations"), 4);
}

TEST_F(Extends, PassesAreAddedRewiredAndRemoved) {
  const auto graph = good(R"({ "extends": "../base.json",
    "passes": { "out": null, "soft": { "type": "Filter", "in": { "image": "tuned.image" } },
                "tuned": { "in": { "image": "bright.image" } }, "bright": { "type": "Filter", "in": { "image": "source.image" } } },
    "outputs": { "image": "soft.image" } })");
  EXPECT_EQ(order_of(graph), "source bright tuned soft");
  EXPECT_EQ(graph.pass("out"), nullptr);
}

TEST_F(Extends, APassOfAnotherTypeInheritsNothing) {
  const auto graph = good(R"({ "extends": "../base.json",
    "passes": { "tuned": { "type": "Filter", "in": { "image": "source.image" } } } })");
  EXPECT_EQ(graph.pass("tuned")->type, "Filter");
}

TEST_F(Extends, ChainsMayBeLong) {
  std::string previous = "../base.json";
  for (int i = 0; i < 20; ++i) {
    const std::string name = "variants/v" + std::to_string(i) + ".json";
    write(name, R"({ "extends": ")" + previous + R"(", "passes": { "tuned": { "params": { "iterations": )" +
                    std::to_string(i + 1) + " } } } }");
    previous = "v" + std::to_string(i) + ".json";
  }
  const auto graph = good(R"({ "extends": "v19.json" })");
  EXPECT_EQ(value<int>(graph, "iterations"), 20);
  EXPECT_EQ(graph.files.size(), 22U);
}

TEST_F(Extends, DiagnosticsPointIntoTheFileThatIsWrong) {
  write("base.json", R"({ "passes": { "s": { "type": "Sorce" } }, "outputs": { "image": "s.image" } })");
  const auto result = compile_variant(R"({ "extends": "../base.json", "colour": 1 })");
  ASSERT_EQ(result.diagnostics.all().size(), 2U);
  EXPECT_THAT(result.diagnostics.all()[0].where.file, testing::EndsWith("variants/v.json"));
  EXPECT_EQ(result.diagnostics.all()[0].code, "unknown-key");
  EXPECT_THAT(result.diagnostics.all()[1].where.file, testing::EndsWith("base.json"));
  EXPECT_EQ(result.diagnostics.all()[1].where.column, 30);
}

TEST_F(Extends, ABrokenBaseIsReportedWhereItIsBroken) {
  write("base.json", "{ \"passes\": { }\n ");
  const auto result = compile_variant(R"({ "extends": "../base.json" })");
  ASSERT_EQ(result.diagnostics.all().size(), 1U);
  EXPECT_THAT(result.diagnostics.all()[0].where.file, testing::EndsWith("base.json"));
  EXPECT_EQ(result.diagnostics.all()[0].code, "json-syntax");
}

}  // namespace
}  // namespace loom::test
