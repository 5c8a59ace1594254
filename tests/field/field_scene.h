#pragma once
// Scenes and pipelines for the radiance field, with the light that is known in them.
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "support/bench.h"

namespace loom::test {

inline const char* const field_pipeline = R"({ "passes": {
    "gbuffer": { "type": "GBuffer" },
    "rsm":     { "type": "RSM", "params": { "shadow_size": 512 } },
    "field":   { "type": "RadianceField", "in": { "lights": "rsm.lights" }, "params": { "behind": 0 } },
    "bounce":  { "type": "GatherProbes", "in": { "surface": "gbuffer.surface", "field": "field.field" } },
    "emitter": { "type": "AreaLight", "in": { "surface": "gbuffer.surface" } },
    "direct":  { "type": "DirectLight", "in": { "surface": "gbuffer.surface", "lights": "rsm.lights" } },
    "indirect": { "type": "Add", "in": { "a": "bounce.irradiance", "b": "emitter.irradiance" } } },
  "outputs": { "image": "bounce.irradiance" } })";

using Overrides = std::vector<graph::Override>;

/// Overrides of the pass `field`: {"probes", "4"}, ...
inline Overrides of_field(const std::vector<std::pair<std::string, std::string>>& values) {
  Overrides set;
  for (const auto& [param, value] : values) set.push_back({"field", param, value});
  return set;
}

/// The six sides of a box, fronts inwards.
inline SceneBuilder& add_room(SceneBuilder& scene, glm::vec3 l, glm::vec3 h, int material) {
  const SceneBuilder outwards = SceneBuilder().box(l, h, 0);
  for (const scene::Mesh& mesh : outwards.build().meshes) {
    const auto& p = mesh.primitives[0].positions;
    scene.triangle(p[0], p[2], p[1], material);
  }
  return scene;
}

class FieldTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) device_ = make_device();
  }
  /// Mean of one output, red.
  static double mean(Bench& bench, const std::string& output, Overrides set, int size = 16) {
    return bench.image(field_pipeline, output, {.size = {size, size}, .set = std::move(set)}).mean().x;
  }
  static double bounce(Bench& bench, Overrides set, int size = 16) {
    return mean(bench, "bounce.irradiance.irradiance", std::move(set), size);
  }
  std::unique_ptr<gpu::CachingDevice> device_;
};

}  // namespace loom::test
