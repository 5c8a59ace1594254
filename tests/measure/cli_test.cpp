// loom compare as a user meets it: what it prints, where it stops, and with which exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "loom/diagnostic.h"
#include "loom/json.h"
#include "measure/images.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace loom {
namespace {

using test::ProcessResult;
using test::uniform;
using testing::HasSubstr;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

class Compare : public testing::Test {
 protected:
  [[nodiscard]] std::string exr(const std::string& name, const ImageLayers& image) const {
    write_exr(dir_ / name, image);
    return dir_ / name;
  }
  static ProcessResult compare(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compare");
    return test::run_loom(arguments);
  }
  static json::Node parse(const ProcessResult& result) {
    Diagnostics diagnostics;
    json::Node node = json::parse(result.out, "stdout", diagnostics);
    EXPECT_FALSE(diagnostics.has_errors()) << result.out << result.err;
    return node;
  }
  /// The code of the first diagnostic in stdout's JSON.
  static std::string first_code(const ProcessResult& result) {
    const json::Node node = parse(result);
    const json::Node* list = node.find("diagnostics");
    if (list == nullptr || list->items.empty()) return "none: " + result.out;
    return list->items.front().find("code")->string;
  }
  static double number(const json::Node& node, const char* key) {
    const json::Node* found = node.find(key);
    return found != nullptr && found->is_number() ? found->number : std::nan("");
  }

  test::TempDir dir_;
};

/// What `render` and `reference` write, cut down to two layers.
ImageLayers reference_layers() {
  ImageLayers image = uniform(8, 6, glm::vec3(1));
  for (const auto& [channel, values] : test::make_image(
                                           8, 6, [](int, int) { return glm::vec3(4); }, "indirect.")
                                           .channels) {
    image.channels[channel] = values;
  }
  image.channels["depth.Z"].assign(48, 2);
  image.channels["depth.Z"][0] = 0;
  image.attributes["loom:quantity"] = "radiance";
  return image;
}

ImageLayers with_quantity(ImageLayers image, const std::string& quantity) {
  image.attributes["loom:quantity"] = quantity;
  return image;
}

TEST_F(Compare, JsonHasEveryMetricUnderItsName) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(1.5f)));
  const std::string reference = exr("r.exr", uniform(8, 6, glm::vec3(1)));
  const ProcessResult result = compare({a, reference, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json::Node node = parse(result);
  EXPECT_EQ(number(node, "version"), 1);
  EXPECT_NEAR(number(node, "relmse"), .25 / 1.01, 1e-12);
  EXPECT_NEAR(number(node, "rmse"), .5, 1e-12);
  EXPECT_NEAR(number(node, "smape"), .5 / 2.51, 1e-12);
  EXPECT_NEAR(number(node, "mean_ratio"), 1.5, 1e-12);
  EXPECT_NEAR(number(node, "p99_abs"), .5, 1e-12);
  EXPECT_EQ(number(node, "non_finite"), 0);
  EXPECT_EQ(number(node, "pixels"), 48);
  EXPECT_GT(number(node, "flip"), 0);
  EXPECT_LT(number(node, "flip"), 1);
}

TEST_F(Compare, TextNamesFilesLayersAndMetrics) {
  const std::string a = exr("a.exr", with_quantity(uniform(8, 6, glm::vec3(4)), "irradiance"));
  const std::string reference = exr("r.exr", reference_layers());
  const ProcessResult result = compare({a, reference});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("a.exr (RGB) against"));
  EXPECT_THAT(result.out, HasSubstr("r.exr (indirect)"));
  EXPECT_THAT(result.out, HasSubstr("mean ratio  1\n"));
  EXPECT_EQ(result.err, "");
}

TEST_F(Compare, FailAboveDecidesTheExitCodeAndStillReports) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(1.5f)));
  const std::string reference = exr("r.exr", uniform(8, 6, glm::vec3(1)));
  EXPECT_EQ(compare({"--fail-above", "rmse=.6", a, reference}).exit_code, 0);
  const ProcessResult above = compare({a, reference, "--fail-above", "rmse=.6", "--fail-above", "relmse=.1", "--json"});
  EXPECT_EQ(above.exit_code, 1);
  EXPECT_EQ(first_code(above), "above-limit");
  EXPECT_NEAR(number(parse(above), "rmse"), .5, 1e-12);
  EXPECT_THAT(above.err, HasSubstr("relmse is 0.24752"));
}

TEST_F(Compare, AMetricWithNoValueIsWithinNoLimit) {
  const std::string black = exr("r.exr", uniform(8, 6, glm::vec3(0)));
  const ProcessResult result = compare({black, black, "--json", "--fail-above", "mean_ratio=2"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(parse(result).find("mean_ratio")->kind, json::Kind::null);
}

TEST_F(Compare, BadLimitsAreUsageErrors) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(1)));
  for (const char* limit : {"relmse", "relms=1", "relmse=x", "relmse=nan", "relmse="}) {
    const ProcessResult result = compare({a, a, "--json", "--fail-above", limit});
    EXPECT_EQ(result.exit_code, 2) << limit;
    EXPECT_EQ(first_code(result), "usage") << limit;
  }
  EXPECT_THAT(compare({a, a, "--fail-above", "relms=1"}).err, HasSubstr("did you mean relmse?"));
}

TEST_F(Compare, BadInputIsNamedWithExitCode2) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(1)));
  const std::string small = exr("small.exr", uniform(8, 5, glm::vec3(1)));
  const std::string broken = dir_.write("broken.exr", "no picture");
  ImageLayers holed = uniform(8, 6, glm::vec3(1));
  holed.channels["G"][13] = nan;
  const std::string with_nan = exr("nan.exr", holed);
  struct Case {
    std::vector<std::string> arguments;
    std::string code;
  };
  const std::vector<Case> cases = {
      {{a, small}, "size-mismatch"},
      {{a, a, "--layer", ":indirect"}, "missing-layer"},
      {{a, with_nan}, "reference-not-finite"},
      {{a, broken}, "bad-image"},
      {{a, dir_ / "absent.exr"}, "bad-image"},
      {{a, dir_.write("x.jpg", "x")}, "unknown-image"},
      {{a, a, "--mask", "depth"}, "missing-layer"},
      {{a, a, "--heatmap", "x.exr"}, "usage"},
      {{a}, "usage"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments = c.arguments;
    arguments.emplace_back("--json");
    const ProcessResult result = compare(arguments);
    EXPECT_EQ(result.exit_code, 2) << c.code << result.err;
    EXPECT_EQ(first_code(result), c.code);
    EXPECT_THAT(result.err, HasSubstr("error[" + c.code + "]"));
  }
  EXPECT_THAT(compare({a, with_nan}).err, HasSubstr("NaN at pixel (5, 1) of channel G"));
}

TEST_F(Compare, NonFinitePixelsAreCountedAndSaid) {
  ImageLayers holed = uniform(8, 6, glm::vec3(1));
  holed.channels["G"][13] = nan;
  holed.channels["R"][13] = nan;
  holed.channels["B"][40] = std::numeric_limits<float>::infinity();
  const std::string a = exr("a.exr", holed);
  const std::string reference = exr("r.exr", uniform(8, 6, glm::vec3(1)));
  const ProcessResult result = compare({a, reference, "--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(number(parse(result), "non_finite"), 2);
  EXPECT_EQ(number(parse(result), "pixels"), 46);
  EXPECT_EQ(number(parse(result), "relmse"), 0);
  EXPECT_THAT(result.err, HasSubstr("2 pixels are NaN or infinite"));
  EXPECT_EQ(compare({a, reference, "--fail-above", "non_finite=0"}).exit_code, 1);
}

TEST_F(Compare, NothingToCompareIsAFailure) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(nan)));
  const std::string reference = exr("r.exr", uniform(8, 6, glm::vec3(1)));
  const ProcessResult result = compare({a, reference, "--json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(first_code(result), "no-valid-pixels");
  EXPECT_EQ(parse(result).find("relmse")->kind, json::Kind::null);
}

TEST_F(Compare, MaskCountsOnlyWhereTheReferenceSeesSomething) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(1)));
  const std::string reference = exr("r.exr", reference_layers());
  EXPECT_EQ(number(parse(compare({a, reference, "--json", "--mask", "depth"})), "pixels"), 47);
  EXPECT_EQ(number(parse(compare({a, reference, "--json", "--mask", "depth.Z"})), "pixels"), 47);
}

TEST_F(Compare, HeatmapIsAPictureOfTheSameSize) {
  const std::string a = exr("a.exr", uniform(8, 6, glm::vec3(0)));
  const std::string reference = exr("r.exr", uniform(8, 6, glm::vec3(1)));
  const std::string heatmap = dir_ / "heat.png";
  EXPECT_EQ(compare({a, reference, "--heatmap", heatmap}).exit_code, 0);
  const ImageLayers picture = read_png(heatmap);
  EXPECT_EQ(picture.width, 8);
  EXPECT_EQ(picture.height, 6);
  EXPECT_GT(picture.channels.at("R")[0], .5f);
}

TEST_F(Compare, NoHeatmapOfWhatHasNoColour) {
  const std::string reference = exr("r.exr", reference_layers());
  const std::string heatmap = dir_ / "heat.png";
  const ProcessResult result = compare({reference, reference, "--layer", "depth", "--heatmap", heatmap, "--json"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(first_code(result), "no-heatmap");
  EXPECT_FALSE(std::filesystem::exists(heatmap));
}

TEST_F(Compare, DisplayReferredPicturesAreNotComparedWithRadiance) {
  const std::string reference = exr("r.exr", reference_layers());
  const std::string png = dir_ / "a.png";
  write_png(png, 8, 6, std::vector<glm::vec3>(48, glm::vec3(.5f)));
  EXPECT_EQ(first_code(compare({png, reference, "--json"})), "quantity-mismatch");
  const json::Node both = parse(compare({png, png, "--json"}));
  EXPECT_EQ(number(both, "flip"), 0);
  EXPECT_EQ(both.find("flip_exposures"), nullptr) << "PNG is measured with LDR-FLIP";
}

}  // namespace
}  // namespace loom
