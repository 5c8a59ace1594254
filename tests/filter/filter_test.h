#pragma once
// Filters of irradiance on surfaces that a camera sees: the irradiance is written by a Shader pass as an expression.
#include <memory>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "support/bench.h"

namespace loom::test {

class FilterTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (IsSkipped()) return;
    device_ = make_device();
  }

  /// A floor of albedo ¼ and a block of albedo ¾ on it.
  static scene::Scene block() {
    SceneBuilder scene;
    const int dark = scene.material(glm::vec3(.25F)), bright = scene.material(glm::vec3(.75F));
    return scene.floor(glm::vec3(0), 20, dark).box({-1, .1F, -1}, {1, 1, 1}, bright).build();
  }
  static scene::Scene plane() {
    SceneBuilder scene;
    return scene.floor(glm::vec3(0), 20, scene.material(glm::vec3(.5F))).build();
  }

  /// The passes `gbuffer` and `source`. `value`, a vec3, may use `pixel`, `x` (world position; zero where nothing is
  /// seen), `albedo`, `uniform_noise` (in [0,1), another in each pixel and frame) and `frame.random`.
  std::string source(const std::string& value) const {
    write_shader("source.comp", R"(
#include "interop/frame.h"
#include "lib/camera.glsl"
#include "lib/sampling.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140) uniform frame_data { FrameData frame; };
layout(std140) uniform surface_data { Camera camera; };
uniform sampler2D surface_depth;
uniform sampler2D surface_albedo;
layout(rgba32f) writeonly uniform image2D e_irradiance;
void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(e_irradiance)))) return;
  float depth = texelFetch(surface_depth, pixel, 0).r;
  vec3 x = depth > 0. ? surface_position(camera, pixel_uv(camera, pixel), depth) : vec3(0);
  float albedo = texelFetch(surface_albedo, pixel, 0).r;
  uvec4 bits = hash(uvec4(pixel, frame.random.xy));
  vec3 uniform_noise = vec3(to_unit(bits.x), to_unit(bits.y), to_unit(bits.z));
  imageStore(e_irradiance, pixel, vec4()" +
                                    value + R"(, 1));
})");
    return R"("gbuffer": { "type": "GBuffer" }, "source": { "type": "Shader", "file": "source.comp",
      "in": { "surface": "gbuffer.surface" },
      "ports": { "in": { "surface": { "type": "Surface", "reads": ["depth", "albedo"] } },
                 "out": { "e": { "type": "Irradiance", "format": "rgba32f" } } } })";
  }
  static std::string pipeline(const std::string& passes, const std::string& outputs) {
    return R"({ "passes": { )" + passes + R"( }, "outputs": { )" + outputs + " } }";
  }

  std::unique_ptr<gpu::CachingDevice> device_;
};

}  // namespace loom::test
