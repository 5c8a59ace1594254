// What a pipeline may not be, whatever else it is.
#include <string>

#include <gtest/gtest.h>

#include "graph/fakes.h"

namespace loom::test {
namespace {

std::string pipeline_of(int passes) {
  std::string text = R"({ "passes": { "p0": { "type": "Source" })";
  for (int i = 1; i < passes; ++i) text += ", \"p" + std::to_string(i) + R"(": { "type": "Source" })";
  return text + R"( }, "outputs": { "image": "p0.image" } })";
}

TEST(Limits, AThousandAndTwentyFourPasses) {
  const Registry registry = fake_registry();
  EXPECT_TRUE(compile(pipeline_of(1024), registry).graph.has_value());
  const auto result = compile(pipeline_of(1025), registry);
  EXPECT_FALSE(result.graph.has_value());
  EXPECT_EQ(result.diagnostics.all().front().code, "too-many-passes") << text_of(result.diagnostics);
}

}  // namespace
}  // namespace loom::test
