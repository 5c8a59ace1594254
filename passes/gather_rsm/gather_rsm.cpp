// GatherRSM: one bounce, from the texels of reflective shadow maps taken as virtual point lights,
//
//   E(x) = Σ_j (Φ_j/π) ⟨n_j, x−x_j⟩₊ ⟨n, x_j−x⟩₊ / r⁴        (Dachsbacher and Stamminger 2005, eq. 1).
//
// `full` adds up every texel: the accurate end. `importance` takes `samples` texels of each light around the point x as
// the light sees it, denser near it: at distance R·ξ₁ in a random direction, with the weight that makes the sum an
// unbiased estimate of the part within R,
//   planar maps, R and texel area a in map widths:  2πR²ξ₁/(N·a)
//   lights with six faces, R as an angle Θ about x: 2πΘ·sin(Θξ₁)/(N·ω_texel).
// Neither tests visibility between x and the texel, as the method has it: light leaks through walls.
//
// A point light has no upper bound as r → 0, but the texel is a patch of area A that reflects Φ, and no receiver gets
// more than Φ/A from it. A disc of that area gives, on its axis, (Φ/π)/(r² + A/π): exact, bounded by Φ/A, and the
// point's value for r ≫ √(A/π). So r⁴ becomes r²(r² + m²·A/π), m = `min_distance` (0 = unbounded, 1 = the disc). What
// this takes away is the output `clamped`; what lies outside R is the output `missed`. Both are computed only when
// asked for (loom render --output bounce.clamped.irradiance).
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rounds.h"
#include "loom/rules.h"

namespace {

using namespace loom;

// VirtualLight in shaders/gather_rsm/virtual_light.glsl.
constexpr std::size_t virtual_light_bytes = 32;

class GatherRSM final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("method", method_, {"importance", "full"}, {.cost = Cost::graph, .doc = "which texels are gathered"});
    p.integer("samples", samples_,
              {.min = 1,
               .max = 65536,
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "importance: texels gathered from each light"});
    p.real("radius", radius_,
           {.min = .01,
            .max = 2,
            .unit = "map widths",
            .scale = Scale::log,
            .doc = "importance: R, how far from the receiver's own place in the map; 1 reaches across a spot's cone, "
                   "and is a quarter turn on six faces"});
    p.real("min_distance", min_distance_,
           {.min = 0,
            .max = 16,
            .unit = "disc radii",
            .doc = "bound on near texels: 1 = a disc of the texel's area, 0 = none"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal");
    auto lights = ports.in("lights", "LightLayers").reads("flux").reads("normal").reads("depth");
    lights.reads("faces", Access::storage_read);
    auto irradiance = ports.out("irradiance", "Irradiance");
    auto clamped = ports.out("clamped", "Irradiance");
    auto missed = ports.out("missed", "Irradiance");
    if (surface.absent() || lights.absent()) {
      const std::string why = surface.absent() ? surface.why_absent() : lights.why_absent();
      for (auto* out : {&irradiance, &clamped, &missed}) out->absent(why);
      return;
    }
    const int channels = rules::channels({lights});
    const auto image = TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels);
    for (auto* out : {&irradiance, &clamped, &missed}) {
      if (out == &missed && method_ == "full") {
        out->absent("the full sum misses nothing");
        continue;
      }
      out->texture("irradiance", image, Access::image_write);
      out->attribute("quantity", "irradiance").attribute("channels", channels);
    }
    if (const TextureDesc* flux = lights.texture("flux")) {
      map_ = {flux->width, flux->height, flux->depth};
    }
    resolution_.declare(ports, channels,
                        method_ == "full" ? parts_of(map_.y * map_.z, map_.x) : parts_of(samples_, facts.lights()));
    const auto texels =
        static_cast<std::size_t>(map_.x) * static_cast<std::size_t>(map_.y) * static_cast<std::size_t>(map_.z);
    ports.scratch("virtual_lights", BufferDesc{texels * virtual_light_bytes});
  }

  void prepare(Device& device, const Bindings& bindings) override {
    make_ = device.program({.files = {"gather_rsm/make.comp"}});
    const bool clamped = bindings.has("clamped.irradiance"), missed = bindings.has("missed.irradiance");
    const Define method{"METHOD", "METHOD_" + method_};
    gathers_ = bindings.has("irradiance.irradiance");
    if (gathers_) resolution_.prepare(device, {.files = {"gather_rsm/gather.comp"}, .defines = {method}});
    lost_ = nullptr;
    if (clamped || missed)
      lost_ = device.program(
          {.files = {"gather_rsm/lost.comp"},
           .defines = {method, {"PARTS", "0"}, {"CLAMPED", clamped ? "1" : "0"}, {"MISSED", missed ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.dispatch(*make_, bindings, map_);
    frame.barrier();
    const auto set_map = [&](const Program& program) { program.set("map", map_); };
    if (gathers_) {
      resolution_.each_program(set_map);
      resolution_.dispatch(frame, bindings);
    }
    if (!lost_) return;
    set_map(*lost_);
    frame.dispatch(*lost_, bindings, {frame.size(), 1});
  }

 private:
  std::string method_ = "importance";
  int samples_ = 128;
  float radius_ = 1;
  float min_distance_ = 1;
  glm::ivec3 map_{1};  // texels, texels, faces
  bool gathers_ = false;
  Resolution resolution_;
  std::shared_ptr<const Program> make_, lost_;
};

}  // namespace

LOOM_PLUGIN("gather_rsm", registry) {
  registry.add<GatherRSM>("GatherRSM", "One bounce from reflective shadow maps, no indirect visibility");
}
