// GatherVpls: irradiance at the visible surface from virtual point lights,
//
//   E(x) = Σ_j (Φ_j/π)·min(G_j, b)·V_j,   G_j = ⟨n_j, x−x_j⟩₊⟨n, x_j−x⟩₊ / r⁴          (Keller 1997),
//
// V by rays against the scene's BVH, or by marching through the voxels (to a point half a cell off the light's surface,
// so that its own sheet does not hide it), or from the maps of VplShadowMaps (lights without a map: by the voxels where
// they are wired, else 1), or 1.
//
// G has no bound as r → 0, where one light stands for a whole patch: b = πN/(m²·A), the value at which a disc of the
// share A/N that each of N paths has of the surface of the scene's box (A) would end, with m = `min_distance` (0 = no
// bound). What it takes away is the output `clamped`; it falls as N grows. With `compensation` rays it is brought back
// without bias (Kollig and Keller, "Illumination in the Presence of Weak Singularities", MCQMC 2004),
//   E(x) += π/R·Σ_ω ρ/π·E(y)·(G(x,y) − b)₊/G(x,y),   y the surface that ω, by density cosθ/π, meets,
// with E(y) = straight light + the bounded sum over some lights + the same again, `compensation_depth` times at most.
//
// `interleave` n: the n² pixels of a tile each take another of n² parts of the lights, times n². A part is a row of
// paths, and any row of 2ᵏ is well spread by itself. Log₂ n iterations of Denoise take the pattern away: its kernel
// vanishes at the pattern's frequencies. (Wald et al., "Interactive Global Illumination using Fast Ray Tracing", EGWR
// 2002.)
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "interop/vpl.h"
#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

// Lights and compensating rays of one dispatch. Mesa's llvmpipe ends a shader invocation silently after 65535 rounds of
// all its loops together (LP_MAX_TGSI_LOOP_ITERATIONS), and other drivers end one that takes too long: a ray takes some
// hundred rounds, a light without one, and four where four texels are looked at.
constexpr int traced_at_once = 64, mapped_at_once = 4096, untraced_at_once = 16384, compensated_at_once = 4;

class GatherVpls final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("visibility", visibility_, {"rays", "voxels", "shadow-maps", "none"},
             {.cost = Cost::graph,
              .doc = "what tells whether anything blocks: the BVH, the voxels, maps (lights that have none: the voxels "
                     "where they are wired, else nothing), or nothing"});
    p.integer("interleave", interleave_,
              {.min = 1,
               .max = 16,
               .unit = "pixels",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "side of the tile over whose pixels the lights are shared out"});
    p.real("min_distance", min_distance_,
           {.min = 0,
            .max = 16,
            .unit = "disc radii",
            .doc = "m, the bound on near lights: 1 = a disc of the area that each stands for, 0 = none"});
    p.integer("compensation", compensation_,
              {.min = 0,
               .max = 256,
               .cost = Cost::graph,
               .doc = "rays a pixel that bring back what the bound takes away; 0 = it is lost"});
    p.integer("compensation_depth", depth_,
              {.min = 1, .max = 8, .cost = Cost::shader, .doc = "how often what a ray finds is compensated itself"});
    p.integer("compensation_lights", lights_,
              {.min = 1, .max = 256, .scale = Scale::log, .doc = "lights, of all, that a compensating ray gathers"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto vpls = ports.in("vpls", "VplSet").reads("lights", Access::storage_read);
    auto voxels = ports.in("voxels", "VoxelScene").optional();
    auto shadows = ports.in("shadows", "VplShadows").optional();
    const bool mapped = visibility_ == "shadow-maps";
    if (mapped || visibility_ == "voxels") voxels.reads("coverage").reads("plane").reads("extent");
    if (mapped) shadows.reads("maps").reads("of", Access::storage_read);
    auto irradiance = ports.out("irradiance", "Irradiance");
    auto clamped = ports.out("clamped", "Irradiance");
    if (visibility_ == "voxels" && !voxels.connected()) {
      ports.error("no-voxels", "visibility by voxels needs the input `voxels`", "wire it to Voxelize's output");
    }
    if (mapped && !shadows.connected()) {
      ports.error("no-shadow-maps", "visibility by shadow maps needs the input `shadows`",
                  "wire it to the output of VplShadowMaps");
    }
    if (surface.absent() || vpls.absent()) {
      const std::string why = surface.absent() ? surface.why_absent() : vpls.why_absent();
      irradiance.absent(why);
      return clamped.absent(why);
    }
    facts_ = facts;
    mapped_ = mapped && !shadows.absent();
    voxels_ = (mapped || visibility_ == "voxels") && !voxels.absent();
    at_once_ = visibility_ == "none" ? untraced_at_once : mapped_ && !voxels_ ? mapped_at_once : traced_at_once;
    // Rows of paths are as equal as they can be.
    const int rows = LOOM_VPL_GROUPS / (interleave_ * interleave_) + 1;
    const int most = vpls.attribute("most", 1);
    const int part = std::min(most, rows * (most / LOOM_VPL_GROUPS + vpls.attribute("orders", 1)));
    dispatches_ =
        std::max((part + at_once_ - 1) / at_once_, (compensation_ + compensated_at_once - 1) / compensated_at_once);
    if (dispatches_ > 1) {
      const auto sum = TextureDesc::image(ports.frame_size(), Format::rgba32f);
      ports.scratch("given", sum, Access::image_read_write);
      ports.scratch("taken", sum, Access::image_read_write);
    }
    const int channels = rules::channels({vpls});
    const auto image = TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels);
    for (auto* out : {&irradiance, &clamped}) {
      out->texture("irradiance", image, Access::image_write);
      out->attribute("quantity", "irradiance").attribute("channels", channels);
    }
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const auto flag = [&](std::string_view member) { return bindings.has(member) ? "1" : "0"; };
    auto defines = scene_defines(facts_);
    defines.emplace_back("RAYS", visibility_ == "rays" ? "1" : "0");
    defines.emplace_back("MAPS", mapped_ ? "1" : "0");
    defines.emplace_back("VOXELS", voxels_ ? "1" : "0");
    defines.emplace_back("IRRADIANCE", flag("irradiance.irradiance"));
    defines.emplace_back("CLAMPED", flag("clamped.irradiance"));
    defines.emplace_back("SEVERAL", dispatches_ > 1 ? "1" : "0");
    defines.emplace_back("COMPENSATION", compensation_ > 0 ? "1" : "0");
    if (compensation_ > 0) {
      defines.emplace_back("DEPTH", std::to_string(depth_));
      defines.emplace_back("PUNCTUAL", facts_.lights() > 0 ? "1" : "0");
      defines.emplace_back("SKY", facts_.sky ? "1" : "0");
      defines.emplace_back("EMITTERS", facts_.emissive_triangles > 0 ? "EMITTERS_many" : "EMITTERS_none");
      defines.emplace_back("TRACED", "1");
    }
    gather_ = device.program({.files = {"gather_vpls/gather.comp"}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const glm::dvec3 size = facts_.bounds_max - facts_.bounds_min;
    gather_->set("box_area", static_cast<float>(2 * (size.x * size.y + size.y * size.z + size.z * size.x)));
    gather_->set("at_once", at_once_);
    gather_->set("dispatches", dispatches_);
    for (int i = 0; i < dispatches_; ++i) {
      gather_->set("index", i);
      frame.dispatch(*gather_, bindings, {frame.size(), 1});
      frame.barrier();
    }
  }

 private:
  std::string visibility_ = "rays";
  int interleave_ = 1;
  float min_distance_ = 1;
  int compensation_ = 0, depth_ = 2, lights_ = 4;
  bool voxels_ = false, mapped_ = false;
  int at_once_ = 1, dispatches_ = 1;  ///< lights of a dispatch, dispatches
  SceneFacts facts_;
  std::shared_ptr<const Program> gather_;
};

}  // namespace

LOOM_PLUGIN("gather_vpls", registry) {
  registry.add<GatherVpls>("GatherVpls", "Irradiance from virtual point lights, with visibility");
}
