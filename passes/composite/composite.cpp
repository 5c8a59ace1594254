// Composite: the radiance towards the viewer,
//
//   L = L_e + ρ/π · (E_direct + E_indirect),
//
// the rendering equation for a Lambertian surface (Kajiya 1986), whose BRDF is ρ/π. Where no surface is seen, L is the
// radiance of the sky. An input that is not wired, or carries nothing, counts as zero. `reflected` leaves L_e and the
// sky out: what a method needs that gathers one more bounce from the picture.
#include <algorithm>
#include <memory>
#include <string>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class Composite final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("parts", parts_, {"all", "reflected"},
             {.cost = Cost::graph, .doc = "all light, or without what surfaces emit themselves and the sky"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("albedo");
    const bool all = parts_ == "all";
    if (all) surface.reads("emission");
    const auto direct = ports.in("direct", "Irradiance").optional().reads("irradiance");
    const auto indirect = ports.in("indirect", "Irradiance").optional().reads("irradiance");
    auto radiance = ports.out("radiance", "Image");
    if (surface.absent()) return radiance.absent(surface.why_absent());
    if (!all && direct.absent() && indirect.absent()) return radiance.absent("no light is reflected");
    lit_ = {all && surface.texture("emission") != nullptr, !direct.absent(), !indirect.absent(), all};
    // The sky is the scene's.
    const int channels = std::max(rules::channels({surface, direct, indirect}), rules::channels(ports, facts));
    radiance.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                     Access::image_write);
    radiance.attribute("channels", channels);
    radiance.attribute("quantity", "radiance");
  }

  void prepare(Device& device, const Bindings&) override {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    program_ = device.program({.files = {"composite/composite.comp"},
                               .defines = {{"EMISSION", flag(lit_.emission)},
                                           {"DIRECT", flag(lit_.direct)},
                                           {"INDIRECT", flag(lit_.indirect)},
                                           {"SKY", flag(lit_.sky)}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  struct Lit {
    bool emission = false, direct = false, indirect = false, sky = false;
  } lit_;
  std::string parts_ = "all";
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("composite", registry) {
  registry.add<Composite>("Composite", "Radiance from albedo, emission and irradiance; sky where nothing is seen");
}
