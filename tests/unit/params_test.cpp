// Parameters: one declaration gives parsing, ranges, errors with places.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "loom/diagnostic.h"
#include "loom/params.h"

namespace loom {
namespace {

struct Values {
  int iterations = 16;
  float radius = 0.1F;
  bool exact = false;
  std::string basis = "sh";
  std::string label = "none";
  glm::vec3 tint{1};
};

Params declared(Values& values) {
  Params params;
  params.integer("iterations", values.iterations, {.min = 1, .max = 64});
  params.real("radius", values.radius, {.min = 0.1, .max = 100, .unit = "m"});
  params.boolean("exact", values.exact, {});
  params.choice("basis", values.basis, {"sh", "sg"}, {});
  params.text("label", values.label, {});
  params.colour("tint", values.tint, {.min = 0, .max = 1});
  return params;
}

/// The code of setting `name` to JSON `text`, or "" where it worked.
std::string set(Values& values, const std::string& name, const std::string& text, std::string* message = nullptr) {
  Params params = declared(values);
  Diagnostics diagnostics;
  const json::Node node = json::parse(text, "f.json", diagnostics);
  const bool done = params.set(name, node, "lpv", diagnostics);
  EXPECT_EQ(done, diagnostics.all().empty());
  if (done) return {};
  if (message != nullptr) *message = to_string(diagnostics.all().back());
  return diagnostics.all().back().code;
}

TEST(Params, SetEveryKind) {
  Values values;
  EXPECT_EQ(set(values, "iterations", "64"), "");
  EXPECT_EQ(set(values, "radius", "2"), "");
  EXPECT_EQ(set(values, "exact", "true"), "");
  EXPECT_EQ(set(values, "basis", "\"sg\""), "");
  EXPECT_EQ(set(values, "label", "\"x\""), "");
  EXPECT_EQ(values.iterations, 64);
  EXPECT_EQ(values.radius, 2);
  EXPECT_TRUE(values.exact);
  EXPECT_EQ(values.basis, "sg");
  EXPECT_EQ(values.label, "x");
  Values colour;
  EXPECT_EQ(set(colour, "tint", "[0, 0.5, 1]"), "");
  EXPECT_EQ(colour.tint, glm::vec3(0, 0.5F, 1));
}

TEST(Params, WrongValuesChangeNothingAndSayWhatIsExpected) {
  Values values;
  std::string message;
  EXPECT_EQ(set(values, "iterations", "65", &message), "param-range");
  EXPECT_THAT(message, testing::HasSubstr("`lpv.iterations` = 65 is outside 1 … 64"));
  EXPECT_EQ(set(values, "iterations", "1.5", &message), "param-type");
  EXPECT_THAT(message, testing::HasSubstr("takes a whole number, but this is `1.5`"));
  EXPECT_EQ(set(values, "iterations", "1e9"), "param-range");
  EXPECT_EQ(set(values, "radius", "\"2\"", &message), "param-type");
  EXPECT_THAT(message, testing::HasSubstr("f.json:1:1"));
  EXPECT_EQ(set(values, "radius", "0.09", &message), "param-range");
  EXPECT_THAT(message, testing::HasSubstr("0.1 … 100 m"));
  EXPECT_EQ(set(values, "exact", "1"), "param-type");
  EXPECT_EQ(set(values, "basis", "\"sq\"", &message), "param-choice");
  EXPECT_THAT(message, testing::HasSubstr("did you mean"));
  EXPECT_EQ(set(values, "basis", "3"), "param-type");
  EXPECT_EQ(set(values, "label", "null"), "param-type");
  EXPECT_EQ(set(values, "tint", "[0, 1]"), "param-type");
  EXPECT_EQ(set(values, "tint", "[0, 1, 2]"), "param-range");
  EXPECT_EQ(set(values, "tint", "1"), "param-type");
  EXPECT_EQ(set(values, "iteratons", "1", &message), "unknown-param");
  EXPECT_THAT(message, testing::HasSubstr("did you mean `iterations`?"));
  EXPECT_EQ(values.iterations, 16);
  EXPECT_EQ(values.radius, 0.1F);
  EXPECT_EQ(values.basis, "sh");
  EXPECT_EQ(values.tint, glm::vec3(1));
}

TEST(Params, TextOfTheCommandLine) {
  Values values;
  Params params = declared(values);
  Diagnostics diagnostics;
  EXPECT_TRUE(params.set_text("iterations", "8", "lpv", diagnostics));
  EXPECT_TRUE(params.set_text("radius", "1e1", "lpv", diagnostics));
  EXPECT_TRUE(params.set_text("exact", "true", "lpv", diagnostics));
  EXPECT_TRUE(params.set_text("basis", "sg", "lpv", diagnostics));
  EXPECT_TRUE(params.set_text("label", "\"with \\\" quote\"", "lpv", diagnostics));
  EXPECT_EQ(values.label, "with \" quote");
  EXPECT_TRUE(params.set_text("label", "true", "lpv", diagnostics));
  EXPECT_EQ(values.label, "true");
  EXPECT_TRUE(params.set_text("label", "", "lpv", diagnostics));
  EXPECT_EQ(values.label, "");
  EXPECT_TRUE(params.set_text("tint", "[1,0,0]", "lpv", diagnostics));
  EXPECT_TRUE(diagnostics.all().empty());
  EXPECT_FALSE(params.set_text("radius", "nan", "lpv", diagnostics));
  EXPECT_FALSE(params.set_text("radius", "", "lpv", diagnostics));
  EXPECT_FALSE(params.set_text("radius", "1e999", "lpv", diagnostics));
  EXPECT_FALSE(params.set_text("iterations", "many", "lpv", diagnostics));
  EXPECT_FALSE(params.set_text("nothing", "1", "lpv", diagnostics));
  ASSERT_EQ(diagnostics.all().size(), 5U);
  EXPECT_EQ(diagnostics.all()[3].where.file, "--set lpv.iterations=many");
  EXPECT_EQ(diagnostics.all()[3].code, "param-type");
  EXPECT_EQ(diagnostics.all()[0].code, "not-finite");
  EXPECT_EQ(diagnostics.all()[1].code, "param-type");
  EXPECT_EQ(diagnostics.all()[2].code, "not-finite");
  EXPECT_EQ(values.radius, 10);
}

TEST(Params, ADeclarationMustHoldItsOwnDefault) {
  Params params;
  int number = 100;
  EXPECT_THROW(params.integer("n", number, {.min = 0, .max = 10}), Error);
  float real = 0.1F;
  EXPECT_NO_THROW(params.real("r", real, {.min = 0.1, .max = 1})) << "0.1f is above 0.1, 0.7f below 0.7";
  EXPECT_THROW(params.real("r", real, {.min = 0, .max = 1}), Error) << "declared twice";
  std::string choice = "c";
  EXPECT_THROW(params.choice("c", choice, {"a", "b"}, {}), Error);
}

TEST(Params, DefaultsAreTheValuesAtDeclaration) {
  Values values;
  Params params = declared(values);
  values.iterations = 3;
  EXPECT_EQ(std::get<int>(params.find("iterations")->default_value), 16);
  EXPECT_EQ(std::get<int>(Params::value_of(*params.find("iterations"))), 3);
  EXPECT_EQ(params.find("nothing"), nullptr);
}

}  // namespace
}  // namespace loom
