// Denoise: irradiance smoothed along surfaces by the edge-avoiding à-trous wavelet transform (Dammertz, Sewtz, Hanika
// and Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010). Iteration i
// takes the mean of 5×5 pixels that lie 2ⁱ apart,
//
//   E'(p) = Σ_q w(p,q)·E(q) / Σ_q w(p,q),    w = h(q−p) · ⟨n_p,n_q⟩₊^k · exp(−½(d/(σ·f))²),
//
// h the B3 spline (1 4 6 4 1)/16 in each direction, n the shading normal, d the distance of either surface point from
// the plane of the other's triangle and f the width of a pixel at the nearer of the two, so that the scene's unit, the
// image's size and the slope of the surface do not matter. After n iterations 2(2ⁿ−1) pixels to each side take part.
// The weights do not look at E: the filter is linear, and a constant stays what it is, to the bit.
//
// It trades noise for blur: what varies along a surface within its reach (contact shadows, colour that bleeds from an
// edge) is smoothed too. Texels that are not finite count for nothing and are filled from their neighbours.
#include <algorithm>
#include <memory>
#include <utility>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class Denoise final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("iterations", iterations_,
              {.min = 0,
               .max = 8,
               .cost = Cost::graph,
               .doc = "n: reaches 2(2ⁿ−1) pixels to each side; 0 lets everything through"});
    p.real("plane_sigma", plane_sigma_,
           {.min = .01,
            .max = 100,
            .unit = "pixel footprints",
            .scale = Scale::log,
            .doc = "σ: distance from the tangent plane at which a pixel counts for exp(−½)"});
    p.real("normal_exponent", normal_exponent_,
           {.min = 0, .max = 1024, .doc = "k: weight of a pixel whose normal is turned by θ is cosᵏθ"});
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    const auto noisy = ports.in("noisy", "Irradiance").reads("irradiance");
    const auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto irradiance = ports.out("irradiance", "Irradiance");
    if (noisy.absent()) return irradiance.absent(noisy.why_absent());
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    if (iterations_ == 0) return irradiance.forwards("noisy");
    const int channels = rules::channels({noisy});
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    irradiance.attribute("quantity", "irradiance");
    if (iterations_ > 1)
      ports.scratch("levels", TextureDesc::layers(ports.frame_size(), std::min(iterations_ - 1, 2), Format::rgba32f),
                    Access::image_read_write);
  }

  void prepare(Device& device, const Bindings&) override {
    const auto program = [&](bool first, bool last) {
      return device.program(
          {.files = {"denoise/denoise.comp"}, .defines = {{"FIRST", first ? "1" : "0"}, {"LAST", last ? "1" : "0"}}});
    };
    first_ = program(true, iterations_ == 1);
    if (iterations_ > 1) last_ = program(false, true);
    if (iterations_ > 2) between_ = program(false, false);
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    for (int i = 0; i < iterations_; ++i) {
      const Program& program = i == 0 ? *first_ : i + 1 == iterations_ ? *last_ : *between_;
      program.set("stride", 1 << i);
      program.set("target", i & 1);
      frame.dispatch(program, bindings, {frame.size(), 1});
      frame.barrier();
    }
  }

 private:
  int iterations_ = 3;
  float plane_sigma_ = 1;
  float normal_exponent_ = 64;
  std::shared_ptr<const Program> first_, between_, last_;
};

}  // namespace

LOOM_PLUGIN("denoise", registry) {
  registry.add<Denoise>("Denoise", "Irradiance smoothed along surfaces, not across their edges (à-trous wavelets)");
}
