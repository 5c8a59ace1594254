// RayMarch: irradiance by marching rays through the voxelized scene.
//
//   E(x) = ∫ L(ω)⟨n,ω⟩₊ dω ≈ π/N · Σ L(ω_i),   ω_i with density cosθ/π,
//
// L what the sheets on the way send back, each weighted by the share of the ray that reaches it (DDA through partial
// occupancy, shaders/lib/voxels.glsl). The sheets send what they reflect: of all orders where `light` is wired
// (Radiosity), else of straight light alone.
#include "loom/plugin.h"

#include <memory>
#include <string>

namespace {

using namespace loom;

class RayMarch final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("rays", rays_, {.min = 1, .max = 4096, .scale = Scale::log, .doc = "rays a pixel and frame"});
    p.boolean(
        "emitter", emitter_,
        {.cost = Cost::graph,
         .doc = "count what comes straight from emissive surfaces and sky, too: for pipelines without AreaLight"});
  }

  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto voxels = ports.in("voxels", "VoxelScene").reads("coverage").reads("plane").reads("extent").reads("radiance");
    if (emitter_) voxels.reads("emission");
    auto light = ports.in("light", "VoxelScene").optional().reads("radiance");
    auto irradiance = ports.out("irradiance", "Irradiance").attribute("quantity", "irradiance");
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    if (voxels.absent()) return irradiance.absent(voxels.why_absent());
    has_light_ = light.texture("radiance") != nullptr;
    if (!has_light_ && voxels.texture("radiance") == nullptr) return irradiance.absent("the voxels carry no radiance");
    emission_ = emitter_ && voxels.texture("emission") != nullptr;
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f), Access::image_write);
  }

  void prepare(Device& device, const Bindings& /*bindings*/) override {
    march_ = device.program({.files = {"ray_march/march.comp"},
                             .defines = {{"LIGHT", has_light_ ? "light_radiance" : "voxels_radiance"},
                                         {"EMITTER", emitter_ ? "1" : "0"},
                                         {"EMISSION", emission_ ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*march_, bindings, {frame.size(), 1});
  }

 private:
  int rays_ = 64;
  bool emitter_ = false, emission_ = false, has_light_ = false;
  std::shared_ptr<const Program> march_;
};

}  // namespace

LOOM_PLUGIN("ray_march", registry) {
  registry.add<RayMarch>("RayMarch", "Irradiance by rays through the voxelized scene");
}
