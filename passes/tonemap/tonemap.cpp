// Tonemap: from radiance to what a display shows, per channel,
//
//   v = curve(2^exposure · L),   image = sRGB(v) in [0,1].
//
// Curves: `linear` v = x; `reinhard` v = x/(1+x) (Reinhard et al. 2002, eq. 3); `aces` the rational fit of the ACES
// filmic curve by Narkowicz (2015), v = x(2.51x + .03)/(x(2.43x + .59) + .14). The encoding is IEC 61966-2-1.
// Negative values show black, infinity white, NaN magenta, so that a broken pass is seen and not averaged away.
#include <memory>
#include <string>

#include "loom/plugin.h"

namespace {

using namespace loom;

class Tonemap final : public Pass {
 public:
  void params(Params& p) override {
    p.real("exposure", exposure_,
           {.min = -30, .max = 30, .unit = "stops", .doc = "radiance is multiplied by 2^exposure"});
    p.choice("curve", curve_, {"aces", "linear", "reinhard"},
             {.cost = Cost::shader, .doc = "how radiance is compressed"});
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    const auto hdr = ports.in("hdr", "Image").reads("image");
    auto image = ports.out("image", "Image");
    if (hdr.absent()) return image.absent(hdr.why_absent());
    image.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba16f), Access::image_write);
    image.attribute("quantity", "display");
  }

  void prepare(Device& device, const Bindings&) override {
    program_ = device.program({.files = {"tonemap/tonemap.comp"}, .defines = {{"CURVE", "curve_" + curve_}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  float exposure_ = 0;
  std::string curve_ = "aces";
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("tonemap", registry) { registry.add<Tonemap>("Tonemap", "Exposure, tone curve and sRGB encoding"); }
