// DirectSpecular: radiance of the punctual lights that the visible surface reflects as a rough mirror,
//
//   L(v) = Σ_lights f_s(v,l) · ⟨n,l⟩₊ · I(ω)/r² · V(x, light),      f_s = D·F·G₂/(4 ⟨n,v⟩⟨n,l⟩),
//
// with the GGX distribution D, Smith's height-correlated G₂ and Fresnel's F: Schlick's for metal and coats, the exact
// one where the surface is glass (docs/specular.md, shaders/lib/ggx.glsl). A perfect mirror (α < 10⁻³) shows such
// lights nowhere: they have no extent. Visibility is found as DirectLight does, in the same ways.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class DirectSpecular final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("shadow", shadow_, {"map", "ray", "none"}, {.cost = Cost::graph, .doc = "how visibility is found"});
    p.boolean("pcf", pcf_, {.doc = "shadow map: blend the four nearest texels instead of taking one"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    surface.reads("specular");
    if (facts.transmission) surface.reads("transmission");
    auto lights = ports.in("lights", "LightLayers");
    if (shadow_ == "map") lights.reads("shadow").reads("faces", Access::storage_read);
    auto radiance = ports.out("radiance", "Image");
    if (surface.absent()) return radiance.absent(surface.why_absent());
    if (surface.texture("specular") == nullptr) return radiance.absent("no surface is specular");
    if (lights.absent()) return radiance.absent(lights.why_absent());
    const int channels = rules::channels(ports, facts);
    radiance.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                     Access::image_write);
    radiance.attribute("channels", channels);
    radiance.attribute("quantity", "radiance");
    glass_ = facts.transmission;
    defines_ = scene_defines(facts);
  }

  void prepare(Device& device, const Bindings&) override {
    auto defines = defines_;
    defines.emplace_back("SHADOW", "SHADOW_" + shadow_);
    defines.emplace_back("GLASS", glass_ ? "1" : "0");
    program_ = device.program({.files = {"direct_specular/direct_specular.comp"}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  std::string shadow_ = "map";
  bool pcf_ = false, glass_ = false;
  std::vector<Define> defines_;
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("direct_specular", registry) {
  registry.add<DirectSpecular>("DirectSpecular", "Shadowed radiance of punctual lights, reflected by rough mirrors");
}
