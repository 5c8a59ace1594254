// FLIP against the values that its authors' own tool gave for the same images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "loom/diagnostic.h"
#include "loom/json.h"
#include "measure/flip.h"
#include "measure/layers.h"

namespace loom {
namespace {

/// The tool computes in float, and prints its numbers to six decimals (means) and five (extremes).
constexpr double tolerance = 1e-4;

std::string folder() {
  const char* shared = std::getenv("LOOM_SHARED");
  return shared == nullptr ? std::string{} : std::string(shared) + "/flip/";
}

bool present() { return !folder().empty() && std::filesystem::exists(folder() + "expected.json"); }

json::Node expected() {
  Diagnostics diagnostics;
  json::Node node = json::parse_file(folder() + "expected.json", diagnostics);
  if (diagnostics.has_errors()) throw Error(diagnostics);
  return node;
}

double number(const json::Node& node, const char* key) {
  const json::Node* found = node.find(key);
  if (found == nullptr || !found->is_number()) throw Error(std::string("no number ") + key);
  return found->number;
}

void expect_map(const measure::FlipMap& map, const json::Node& values) {
  EXPECT_NEAR(map.mean, number(values, "mean"), tolerance);
  EXPECT_NEAR(*std::min_element(map.error.begin(), map.error.end()), number(values, "min"), tolerance);
  EXPECT_NEAR(*std::max_element(map.error.begin(), map.error.end()), number(values, "max"), tolerance);
}

#define SKIP_WHERE_ABSENT() \
  if (!present()) GTEST_SKIP() << "needs the images and values of flip/expected.json in the folder $LOOM_SHARED"

TEST(FlipExpected, LdrPairsAreReproduced) {
  SKIP_WHERE_ABSENT();
  const json::Node all = expected();
  ASSERT_NE(all.find("ldr"), nullptr);
  ASSERT_FALSE(all.find("ldr")->members.empty());
  for (const auto& [name, where, values] : all.find("ldr")->members) {
    SCOPED_TRACE(name);
    const auto reference = measure::read_image(folder() + name + "_ref.png");
    const auto test = measure::read_image(folder() + name + "_test.png");
    expect_map(measure::flip_ldr(measure::find_layer(test, ""), measure::find_layer(reference, ""), number(all, "ppd")),
               values);
  }
}

TEST(FlipExpected, HdrPairsAreReproducedWithTheirExposures) {
  SKIP_WHERE_ABSENT();
  const json::Node all = expected();
  ASSERT_NE(all.find("hdr_aces"), nullptr);
  ASSERT_FALSE(all.find("hdr_aces")->members.empty());
  for (const auto& [name, where, values] : all.find("hdr_aces")->members) {
    SCOPED_TRACE(name);
    const auto reference = measure::read_image(folder() + name + "_ref.exr");
    const auto test = measure::read_image(folder() + name + "_test.exr");
    const auto map =
        measure::flip_hdr(measure::find_layer(test, ""), measure::find_layer(reference, ""), number(all, "ppd"));
    expect_map(map, values);
    ASSERT_TRUE(map.exposures);
    EXPECT_NEAR(map.exposures->start, number(values, "start_exposure"), tolerance);
    EXPECT_NEAR(map.exposures->stop, number(values, "stop_exposure"), tolerance);
    EXPECT_EQ(map.exposures->count, static_cast<int>(number(values, "num_exposures")));
  }
}

}  // namespace
}  // namespace loom
