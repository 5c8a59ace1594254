// GatherVolume: irradiance at the visible surface from an intensity volume.
//
//   E(n) = ∫ L(ω)⟨n,ω⟩₊ dω,   L = ℓ·I/s³ = 2I/(3s²)
//
// Radiance is track length over volume: light of intensity I crosses a cubic cell of size s on a mean chord ℓ = 2s/3.
// Exact for isotropic light; light along an axis reads a third low. The volume is read half a cell off the surface, in
// the finest cascade that holds the point, blended into the next over its border. With `without` (ScreenSpaceGI's
// `ended`) the directions for which a near field has answered are left out of the integral, which is then always
// linear.
#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rules.h"

#include <string>

namespace {

using namespace loom;

class GatherVolume final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("reconstruction", reconstruction_, {"linear", "non-negative"},
             {.cost = Cost::shader, .doc = "two bands clamped at zero, or a form that never rings below it"});
    p.real("blend", blend_,
           {.min = 0, .max = 8, .unit = "cells", .doc = "border over which a cascade passes over into the next"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    ports.in("surface", "Surface").reads("depth").reads("normal");
    auto volume = ports.in("volume", "ShVolume").reads("red").reads("green").reads("blue");
    const auto without = ports.in("without", "Image").optional().reads("image");
    without_ = !without.absent();
    auto irradiance = ports.out("irradiance", "Irradiance").attribute("quantity", std::string("irradiance"));
    if (volume.absent()) return irradiance.absent(volume.why_absent());
    channels_ = rules::channels({volume});
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels_),
                       Access::image_write);
    irradiance.attribute("channels", channels_);
    resolution_.declare(ports, channels_);
  }

  void prepare(Device& device, const Bindings& /*bindings*/) override {
    resolution_.prepare(device, {.files = {"gather_volume/gather.comp"},
                                 .defines = {{"CHANNELS", std::to_string(channels_)},
                                             {"WITHOUT", without_ ? "1" : "0"},
                                             {"NON_NEGATIVE", reconstruction_ == "non-negative" ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override { resolution_.dispatch(frame, bindings); }

 private:
  std::string reconstruction_ = "linear";
  float blend_ = 2;
  int channels_ = 3;
  bool without_ = false;
  Resolution resolution_;
};

}  // namespace

LOOM_PLUGIN("gather_volume", registry) {
  registry.add<GatherVolume>("GatherVolume", "Irradiance at the visible surface from an intensity volume");
}
