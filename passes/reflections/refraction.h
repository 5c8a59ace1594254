#pragma once
// Refraction: the radiance that is seen through glass,
//
//   L_t(v) = τ·c·(1−F)·L_inside(w) ≈ mean over N microfacet normals h,   w by Snell's law about h,
//
// τ the share of the surface that is glass, c its base colour, F Fresnel's reflectance (docs/specular.md); a smooth
// surface takes one ray, a rough one N normals that the view sees, with Smith's shadowing of the way in. The ray is
// followed through the glass against the scene's BVH: where it meets the surface from within, c(1−F) of it leaves by
// Snell's law, and what F reflects goes on, `bounces` times at most (total reflection included). The rest is lost. What
// leaves brings what Reflections' rays bring: from `picture` where that shows it, else from `voxels`, else the sky.
// Radiance is n² larger within: the two crossings cancel.
//
// Modelled: solid glass of any shape with one index. Exits are smooth, and flat as the triangles are; the colours are
// the materials' factors; what is within glass and what is seen through a second piece of glass is not refracted again.
#include "specular_rays.h"

namespace loom {

class Refraction final : public SpecularRays {
 public:
  void params(Params& p) override {
    SpecularRays::params(p);
    p.integer("bounces", bounces_,
              {.min = 1, .max = 16, .cost = Cost::graph, .doc = "how often a ray meets the surface from within"});
  }
  void reflect(Ports& ports, const SceneFacts& facts) override {
    declare(ports, facts, "transmission", "no surface is glass", bounces_);
    defines_ = scene_defines(facts);
  }
  void prepare(Device& device, const Bindings& bindings) override {
    compile(device, bindings, "refraction/refraction.comp", defines_);
  }

 private:
  int bounces_ = 3;
  std::vector<Define> defines_;
};

}  // namespace loom
