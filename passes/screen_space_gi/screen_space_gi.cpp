// ScreenSpaceGI: irradiance from what the camera sees near each pixel, and from a far field for the rest.
//
//   E(x) = π/N · Σ_{rays that end on a visible front} L(p) + (1 − o)·E_far(x)
//
// Rays are cosine-distributed about the normal and end on the first piece of the depth image that they meet within
// `radius`, `thickness` metres thick along the view; thirty-two share a walk over the image (horizon search with a
// visibility bitmask: shaders/lib/screen_rays.glsl). L is the picture wired as `radiance`: what surfaces reflect,
// without what they emit themselves, which AreaLight brings. `o` is the share of rays that ended.
//
// Alone what the image does not show is dark. On top of a field, light from within the radius comes from the image and
// light from beyond from the field, less the directions of the rays that have ended. Two forms:
//   `ended`, the output c_lm = π/N·Σ Y_lm(ω) over those rays, is wired to GatherProbes or GatherVolume as `without`,
//     E = E_near + Σ L_lm·(A_l Y_lm(n) − c_lm);
//   `far`, any pass's irradiance, loses their share o, as if the field were as bright there as on the whole,
//     E = E_near + (1 − o)·E_far.
// A ray has one source or the other, so that no light is counted twice; in a furnace the second sum is E_far to the
// last digit. What directions the field's bands cannot tell apart the first cannot either.
//
// A ray that meets another side of a piece than the one seen ends as well. `hidden` says what it brings: what the front
// sends, its share of the far field, or nothing. How many rays left the image or met such a side is the output
// `unknown`.
#include <memory>
#include <string>
#include <utility>

#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class ScreenSpaceGI final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("slices", slices_,
              {.min = 1, .max = 32, .scale = Scale::log, .doc = "image lines walked a pixel, with 32 rays each"});
    p.integer("steps", steps_,
              {.min = 2,
               .max = 512,
               .scale = Scale::log,
               .doc = "texels read on each half of a line; every one that it crosses where these suffice, else denser "
                      "near the pixel"});
    p.real("radius", radius_,
           {.min = 1e-4, .max = 1e6, .unit = "m", .scale = Scale::log, .doc = "how far rays are followed"});
    p.real("thickness", thickness_,
           {.min = 1e-4,
            .max = 1e6,
            .unit = "m",
            .scale = Scale::log,
            .doc = "how far what is seen goes on behind its surface, along the view: rays pass behind that"});
    p.choice("hidden", hidden_, {"front", "far", "dark"},
             {.cost = Cost::shader,
              .doc = "what a side sends that the camera does not see: as much as the front, the share of the far field "
                     "in its direction, or nothing"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    const auto radiance = ports.in("radiance", "Image").reads("image");
    const auto far = ports.in("far", "Irradiance").optional().reads("irradiance");
    auto irradiance = ports.out("irradiance", "Irradiance").attribute("quantity", "irradiance");
    auto unknown = ports.out("unknown", "Image").attribute("quantity", "shares of rays");
    auto ended = ports.out("ended", "Image").attribute("quantity", "transfer");
    if (surface.absent()) {
      unknown.absent(surface.why_absent());
      ended.absent(surface.why_absent());
      return irradiance.absent(surface.why_absent());
    }
    unknown.texture("image", TextureDesc::image(ports.frame_size(), Format::rgba32f), Access::image_write);
    ended.texture("image", TextureDesc::layers(ports.frame_size(), 3, Format::rgba32f), Access::image_write);
    ended.cleared("image");
    if (radiance.absent()) return irradiance.absent(radiance.why_absent());
    const int channels = rules::channels({radiance, far});
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    far_ = !far.absent();
    resolution_.declare(ports, channels);
  }

  void prepare(Device& device, const Bindings& bindings) override {
    light_ = bindings.has("irradiance.irradiance");
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    const bool unknown = bindings.has("unknown.image");
    bool ended = bindings.has("ended.image");
    const Define hidden{"HIDDEN", "HIDDEN_" + hidden_};
    if (light_) {
      const bool with_light = ended && resolution_.full();
      resolution_.prepare(device, {.files = {"screen_space_gi/near_light.comp"},
                                   .defines = {{"FAR", flag(far_)}, {"ENDED", flag(with_light)}, hidden}});
      if (with_light) ended = false;
    }
    rays_ = nullptr;
    if (unknown || ended)
      rays_ = device.program({.files = {"screen_space_gi/rays.comp"},
                              .defines = {{"UNKNOWN", flag(unknown)}, {"ENDED", flag(ended)}, hidden}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    if (light_) resolution_.dispatch(frame, bindings);
    if (rays_) frame.dispatch(*rays_, bindings, {frame.size(), 1});
  }

 private:
  int slices_ = 4;
  int steps_ = 32;
  float radius_ = 1e6F;
  float thickness_ = .5F;
  std::string hidden_ = "front";
  bool far_ = false, light_ = false;
  Resolution resolution_;
  std::shared_ptr<const Program> rays_;  ///< what becomes of them, at every pixel
};

}  // namespace

LOOM_PLUGIN("screen_space_gi", registry) {
  registry.add<ScreenSpaceGI>("ScreenSpaceGI", "Irradiance from what the camera sees nearby, and a far field beyond");
}
