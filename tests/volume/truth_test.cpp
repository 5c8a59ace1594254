// The shipped pipelines against the path tracer, on both Cornell boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "support/gl.h"
#include "support/render.h"

namespace loom::test {
namespace {

constexpr const char* source = LOOM_SOURCE_DIR;

graph::ReadImage render(const std::string& pipeline, const std::string& scene, const std::string& output, int frames) {
  return render_text(std::string(source) + "/pipelines/" + pipeline + ".json",
                     std::string(source) + "/configs/scenes/" + scene + ".gltf", {48, 48},
                     {.output = output, .frames = frames});
}

double mean_ratio(const graph::ReadImage& a, const graph::ReadImage& truth) {
  double sum = 0, of_truth = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    for (int c = 0; c < 3; ++c) sum += a.texels[i][c], of_truth += truth.texels[i][c];
  }
  return sum / of_truth;
}

/// As `loom compare` has it: mean of (a−r)²/(r²+1e-2) over pixels and channels.
double relative_error(const graph::ReadImage& a, const graph::ReadImage& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double r = truth.texels[i][c];
      sum += std::pow(a.texels[i][c] - r, 2) / (r * r + 1e-2);
    }
  }
  return sum / (3 * static_cast<double>(a.texels.size()));
}

/// What a pipeline keeps on both boxes: bounds of the mean ratio of `indirect`, and of the relMSE of `hdr` as a share
/// of that of the picture without indirect light.
struct Promise {
  const char* pipeline;
  double low, high, share;
};
constexpr Promise promises[] = {{"lpv-fast", .6, 1.4, .5},
                                {"lpv", .6, 1.4, .5},
                                {"lpv-cascaded-accurate", .7, 1.3, .5},
                                {"lpv-surface", .6, 1.4, .5},
                                {"lpv-voxel", .6, 1.4, .5},
                                {"ray-march", .85, 1.15, .2},
                                {"ray-march-probes", .85, 1.15, .2},
                                {"cone-trace", .7, 1.3, .2},
                                {"radiance-field", .85, 1.15, .2},
                                {"radiance-field-voxel", .85, 1.15, .2}};

class Truth : public GlTest {
 protected:
  static void judge(const char* scene) {
    const auto indirect = render("reference", scene, "indirect", 32), hdr = render("reference", scene, "hdr", 32);
    // One sample a pixel: edges alone cost a few thousandths of the relMSE. Without indirect light it is .22.
    const double none = relative_error(render("direct", scene, "hdr", 1), hdr);
    for (const Promise& p : promises) {
      const double ratio = mean_ratio(render(p.pipeline, scene, "indirect", 1), indirect);
      EXPECT_GT(ratio, p.low) << scene << ' ' << p.pipeline;
      EXPECT_LT(ratio, p.high) << scene << ' ' << p.pipeline;
      EXPECT_LT(relative_error(render(p.pipeline, scene, "hdr", 1), hdr), p.share * none) << scene << ' ' << p.pipeline;
    }
    const double bounce = mean_ratio(render("lpv", scene, "bounce", 1), render("reference", scene, "bounce", 32));
    EXPECT_GT(bounce, .7) << scene;
    EXPECT_LT(bounce, 1.3) << scene;
  }
};

// Two tests, so that two cores share them.
TEST_F(Truth, IndirectLightOfTheVariantsOnTheCornellBox) { judge("cornell-box"); }
TEST_F(Truth, IndirectLightOfTheVariantsOnTheEmissiveCornellBox) { judge("cornell-box-emissive"); }

}  // namespace
}  // namespace loom::test
