// The shipped pipelines against the path tracer on the Cornell boxes.
#include <string>

#include <gtest/gtest.h>
#include <glm/vec4.hpp>

#include "support/gl.h"
#include "support/render.h"

namespace loom::test {
namespace {

class FieldReference : public GlTest {};

double sum(const graph::ReadImage& image) {
  double total = 0;
  for (const glm::vec4& texel : image.texels) total += texel.x + texel.y + texel.z;
  return total;
}

/// Σ of `bounce` over the path tracer's, both with so many reflections.
double ratio(const std::string& pipeline, const std::string& scene, const std::string& bounces) {
  const std::string path = LOOM_SOURCE_DIR "/configs/scenes/" + scene;
  const auto field = render_text(LOOM_SOURCE_DIR "/pipelines/" + pipeline, path, {32, 32},
                                 {.output = "bounce", .overrides = {{"field", "bounces", bounces}}});
  const auto truth = render_text(
      LOOM_SOURCE_DIR "/pipelines/reference.json", path, {32, 32},
      {.output = "bounce", .overrides = {{"reference", "samples", "128"}, {"reference", "bounces", bounces}}});
  return sum(field) / sum(truth);
}

// Each number of reflections by itself: 131072 paths leave a standard error of under 1 % of the mean.
TEST_F(FieldReference, EveryOrderAgreesOnTheCornellBoxes) {
  for (const char* scene : {"cornell-box.gltf", "cornell-box-emissive.gltf"}) {
    for (const char* bounces : {"1", "2", "6"}) {
      EXPECT_NEAR(ratio("radiance-field.json", scene, bounces), 1, .06) << scene << ' ' << bounces;
    }
  }
}

TEST_F(FieldReference, TheFastOneIsNotFarOff) {
  for (const char* scene : {"cornell-box.gltf", "cornell-box-emissive.gltf"}) {
    EXPECT_NEAR(ratio("radiance-field-fast.json", scene, "4"), 1, .1) << scene;
  }
}

}  // namespace
}  // namespace loom::test
