// Composite: the radiance towards the viewer,
//
//   L = L_e + ρ/π · (1 − E(μ)) · (E_direct + E_indirect) + L_s,
//
// the rendering equation (Kajiya 1986) for a diffuse surface, whose BRDF is ρ/π, under a specular one that reflects the
// share E(μ) of what it sees (directional albedo, μ the cosine of the view, docs/specular.md): the light under it has
// come through on its way in and out, and diffuse light is what is left of it. On the way in the factor is its mean
// over directions, which the energy balance turns into the normalisation: exact where light is the same from all
// sides. Without specular surfaces E = 0. L_s, the radiance that they reflect, is the input `specular`. Where no
// surface is seen, L is the radiance of the sky. An input that is not wired, or carries nothing, counts as zero.
// `reflected` leaves L_e and the sky out: what a method needs that gathers one more bounce from the picture.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

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
    if (facts.specular) surface.reads("specular").reads("normal");
    const auto direct = ports.in("direct", "Irradiance").optional().reads("irradiance");
    const auto indirect = ports.in("indirect", "Irradiance").optional().reads("irradiance");
    const auto specular = ports.in("specular", "Image").optional().reads("image");
    auto radiance = ports.out("radiance", "Image");
    if (surface.absent()) return radiance.absent(surface.why_absent());
    if (!all && direct.absent() && indirect.absent() && specular.absent())
      return radiance.absent("no light is reflected");
    lit_ = {.emission = all && surface.texture("emission") != nullptr,
            .direct = !direct.absent(),
            .indirect = !indirect.absent(),
            .specular = !specular.absent(),
            .coat = facts.specular && surface.texture("specular") != nullptr,
            .sky = all,
            .sky_image = facts.sky_image};
    // The sky is the scene's.
    const int channels =
        std::max(rules::channels({surface, direct, indirect, specular}), rules::channels(ports, facts));
    radiance.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                     Access::image_write);
    radiance.attribute("channels", channels);
    radiance.attribute("quantity", "radiance");
  }

  void prepare(Device& device, const Bindings&) override {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    std::vector<Define> defines{
        {"EMISSION", flag(lit_.emission)},        {"DIRECT", flag(lit_.direct)}, {"INDIRECT", flag(lit_.indirect)},
        {"SPECULAR", flag(lit_.specular)},        {"COAT", flag(lit_.coat)},     {"SKY", flag(lit_.sky)},
        {"SCENE_SKY_IMAGE", flag(lit_.sky_image)}};
    program_ = device.program({.files = {"composite/composite.comp"}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  struct Lit {
    bool emission = false, direct = false, indirect = false, specular = false, coat = false, sky = false;
    bool sky_image = false;
  } lit_;
  std::string parts_ = "all";
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("composite", registry) {
  registry.add<Composite>(
      "Composite", "Radiance from albedo, emission, irradiance and what is reflected; sky where nothing is seen");
}
