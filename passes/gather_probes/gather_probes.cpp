// GatherProbes: irradiance at the visible surface from the probes of a radiance field.
//
//   E(x, n) = Σ_p w_p E_p(n) / Σ_p w_p,   E_p(n) = Σ A_l L_lm Y_lm(n),   A = π, 2π/3, π/4, 0, −π/24
//
// (or the sum over spherical Gaussians, shaders/lib/spherical_gaussians.glsl), over the eight probes around x, w_p =
// trilinear · backface term · visibility by the moments of the distance that the probe sees (shaders/lib/probes.glsl
// has the terms, and what is done where all weights vanish). With `without` (ScreenSpaceGI's `ended`) the directions
// for which a near field has answered are left out: A_l Y_lm(n) becomes A_l Y_lm(n) − c_lm.
#include <string>

#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class GatherProbes final : public Pass {
 public:
  void params(Params& p) override { resolution_.params(p); }

  void reflect(Ports& ports, const SceneFacts& /*facts*/) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto field = ports.in("field", "ProbeField").reads("coefficients").reads("moments").reads("state");
    const auto without = ports.in("without", "Image").optional().reads("image");
    auto irradiance = ports.out("irradiance", "Irradiance");
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    if (field.absent()) return irradiance.absent(field.why_absent());
    const int channels = rules::channels({field});
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    irradiance.attribute("quantity", "irradiance");
    resolution_.declare(ports, channels);
    coefficients_ = field.attribute("coefficients", 9);
    without_ = !without.absent();
    gaussians_ = field.attribute("basis", "sh") == "sg";
  }

  void prepare(Device& device, const Bindings& /*bindings*/) override {
    resolution_.prepare(device, {.files = {"gather_probes/gather.comp"},
                                 .defines = {{"COEFFICIENTS", std::to_string(coefficients_)},
                                             {"GAUSSIANS", gaussians_ ? "1" : "0"},
                                             {"WITHOUT", without_ ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override { resolution_.dispatch(frame, bindings); }

 private:
  int coefficients_ = 9;
  bool gaussians_ = false, without_ = false;
  Resolution resolution_;
};

}  // namespace

LOOM_PLUGIN("gather_probes", registry) {
  registry.add<GatherProbes>("GatherProbes", "Irradiance at the visible surface from the probes of a radiance field");
}
