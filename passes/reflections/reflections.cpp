// Reflections: the radiance that surfaces reflect specularly, of everything but punctual lights (which are
// DirectSpecular's): emitters, sky and what other surfaces send,
//
//   L_s(v) = ∫ L(l) f_s(v,l)⟨n,l⟩ dl ≈ 1/N · Σ L(l_i)·F(v·h_i)·G₂/G₁,   l_i = 2(v·h_i)h_i − v,
//
// h_i by the distribution of GGX normals that the view sees (Heitz, JCGT 7(4), 2018), so that no weight is larger than
// 1; a mirror takes one ray. In uniform light the sum is L·E(μ), the directional albedo of the lobe. Where a surface is
// glass, F is Fresnel's, not Schlick's (docs/specular.md).
//
// L of a ray comes, as far as they are wired,
//   from `picture`, a radiance image of what the camera sees: the ray is followed through the depth image, over `steps`
//   texels at most, and takes what it meets on a side that is seen (shaders/lib/screen_march.glsl);
//
//   from `voxels`, with what their sheets reflect (`light`, or straight light alone) and emit: from where the picture
//   ends, or hides what follows, by a march through the sheets (shaders/lib/voxels.glsl);
//
//   from the sky, where nothing is met. Without `voxels`, a ray that gets lost in the picture takes what hides it.
//
// What a picture shows of glass is looked through. The output `ends` has the shares of rays that were found in the
// picture, left it, and got lost in it.
#include "loom/plugin.h"
#include "refraction.h"
#include "specular_rays.h"

namespace {

using namespace loom;

class Reflections final : public SpecularRays {
 public:
  void reflect(Ports& ports, const SceneFacts& facts) override {
    declare(ports, facts, "specular", "no surface is specular", 0);
  }
  void prepare(Device& device, const Bindings& bindings) override {
    compile(device, bindings, "reflections/reflections.comp");
  }
};

}  // namespace

LOOM_PLUGIN("reflections", registry) {
  registry.add<Reflections>("Reflections", "What surfaces reflect specularly: from the picture, the voxels, the sky");
  registry.add<Refraction>("Refraction", "What is seen through glass: from the picture, the voxels, the sky");
}
