// AreaLight: irradiance straight from emissive triangles and the sky, the `emitter` part of indirect light,
//
//   E(x) = Σ_triangles L ∫ V ⟨n,ω⟩₊ dω + L_sky ∫ V ⟨n,ω⟩₊ dω.
//
// Few triangles (at most `closed_form`): the unblocked integral is Lambert's formula, ½ Σ Θ_i ⟨Γ_i,n⟩ over the edges of
// the triangle cut at the horizon, exact; it is multiplied by the visible share
//   V̄ = Σ w_k V_k / Σ w_k,   w_k = cosθ cosθ'/r²,
// over low-discrepancy points of the triangle (a ratio estimator: exactly 1 where nothing blocks and 0 where everything
// does; its bias, of order 1/samples, lives in penumbrae alone).
// Many triangles: points chosen by emitted power, E = 1/N Σ L cosθ cosθ'/(r² p) V with p = power share/area, unbiased.
// Sky: cosine-weighted rays, E = π·L·(share that escape). All points are seeded: the same seed, the same image.
#include <string>
#include <utility>
#include <vector>

#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rounds.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class AreaLight final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("samples", samples_,
              {.min = 1,
               .max = 4096,
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "visibility rays a pixel for all emissive triangles together, and again for the sky"});
    p.choice("visibility", visibility_, {"ray", "none"}, {.cost = Cost::graph, .doc = "whether anything blocks"});
    p.integer(
        "closed_form", closed_form_,
        {.min = 0,
         .max = 256,
         .unit = "triangles",
         .cost = Cost::graph,
         .doc = "up to so many emissive triangles are integrated exactly (at least 4 rays each); more are sampled"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto irradiance = ports.out("irradiance", "Irradiance");
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    const bool dark = facts.emissive_triangles == 0 && !facts.sky;
    if (dark && ports.rule("no-emission")) {
      ports.decide("no-emission", "no light straight from surfaces or sky", "no emissive triangle, black sky");
      return irradiance.absent("no surface emits and the sky is black");
    }
    const int channels = rules::channels(ports, facts);
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    irradiance.attribute("quantity", "irradiance");
    const int kinds = (facts.emissive_triangles > 0 ? 1 : 0) + (facts.sky ? 1 : 0);
    resolution_.declare(ports, channels, visibility_ == "ray" ? parts_of(kinds * samples_, rounds_of_traced_ray) : 1);
    sky_ = facts.sky;
    emitters_ = facts.emissive_triangles == 0 ? "none" : facts.emissive_triangles <= closed_form_ ? "few" : "many";
    defines_ = scene_defines(facts);
  }

  void prepare(Device& device, const Bindings&) override {
    auto defines = defines_;
    defines.emplace_back("SKY", sky_ ? "1" : "0");
    defines.emplace_back("EMITTERS", "EMITTERS_" + emitters_);
    defines.emplace_back("TRACED", visibility_ == "ray" ? "1" : "0");
    resolution_.prepare(device, {.files = {"area_light/area_light.comp"}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override { resolution_.dispatch(frame, bindings); }

 private:
  int samples_ = 16;
  int closed_form_ = 8;
  std::string visibility_ = "ray";
  bool sky_ = false;
  std::string emitters_ = "none";
  std::vector<Define> defines_;
  Resolution resolution_;
};

}  // namespace

LOOM_PLUGIN("area_light", registry) {
  registry.add<AreaLight>("AreaLight", "Irradiance straight from emissive triangles and the sky");
}
