// DirectLight: irradiance straight from the punctual lights,
//
//   E(x) = Σ_lights I(ω)/r² · ⟨n,l⟩₊ · V(x, light),      directional: E⊥ · ⟨n,l⟩₊ · V,
//
// n the shading normal, ω = −l the direction from the light, I with glTF's spot edge. A light behind the triangle
// (⟨n_g,l⟩ ≤ 0) does not reach it. V comes from the lights' shadow maps (`map`, receiver-plane test in
// shaders/lib/shadow.glsl, which says what its bound is), from rays through the scene (`ray`, exact), or is 1 (`none`).
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class DirectLight final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("shadow", shadow_, {"map", "ray", "none"}, {.cost = Cost::graph, .doc = "how visibility is found"});
    p.boolean("pcf", pcf_, {.doc = "shadow map: blend the four nearest texels instead of taking one"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto lights = ports.in("lights", "LightLayers");
    if (shadow_ == "map") lights.reads("shadow").reads("faces", Access::storage_read);
    auto irradiance = ports.out("irradiance", "Irradiance");
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    if (lights.absent()) return irradiance.absent(lights.why_absent());
    const int channels = rules::channels(ports, facts);
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    irradiance.attribute("quantity", "irradiance");
    defines_ = scene_defines(facts);
  }

  void prepare(Device& device, const Bindings&) override {
    auto defines = defines_;
    defines.emplace_back("SHADOW", "SHADOW_" + shadow_);
    program_ = device.program({.files = {"direct_light/direct_light.comp"}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  std::string shadow_ = "map";
  bool pcf_ = false;
  std::vector<Define> defines_;
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("direct_light", registry) {
  registry.add<DirectLight>("DirectLight", "Shadowed irradiance straight from point, spot and directional lights");
}
