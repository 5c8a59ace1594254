// AmbientOcclusion: the cheap end of near-field light, from the depth image alone,
//
//   E(x) = π · L_ambient · o(x),
//
// o the cosine-weighted share of the hemisphere that is open: directions in which nothing stands within `radius`
// (Zhukov et al. 1998), by the rays of ScreenSpaceGI (shaders/lib/screen_rays.glsl), what is seen being `thickness`
// metres thick. Rays that leave the image count as open.
//
// L_ambient is one radiance for the whole scene: the mean of a radiance field where one is wired, over the sphere and
// over all probes that stand in the open, L = Σ c00·Y00 / N, or else the parameter `ambient`. So E is exact where light
// comes from all open directions alike and what stands near is black; a scene has neither, and what near surfaces
// reflect is missing.
#include <memory>
#include <string>

#include <glm/vec3.hpp>

#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class AmbientOcclusion final : public Pass {
 public:
  void params(Params& p) override {
    p.colour("ambient", ambient_,
             {.min = 0, .max = 1e9, .unit = "W/(m² sr)", .doc = "L_ambient where no field is wired"});
    p.integer("slices", slices_,
              {.min = 1, .max = 32, .scale = Scale::log, .doc = "image lines walked a pixel, with 32 rays each"});
    p.integer("steps", steps_,
              {.min = 2, .max = 512, .scale = Scale::log, .doc = "texels read on each half of a line"});
    p.real("radius", radius_,
           {.min = 1e-4, .max = 1e6, .unit = "m", .scale = Scale::log, .doc = "what stands nearer occludes"});
    p.real("thickness", thickness_,
           {.min = 1e-4,
            .max = 1e6,
            .unit = "m",
            .scale = Scale::log,
            .doc = "how far what is seen goes on behind its surface, along the view: rays pass behind that"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto field = ports.in("field", "ProbeField").optional().reads("coefficients").reads("state");
    auto irradiance = ports.out("irradiance", "Irradiance").attribute("quantity", "irradiance");
    if (surface.absent()) return irradiance.absent(surface.why_absent());
    if (field.connected() && field.absent()) return irradiance.absent(field.why_absent());
    field_ = field.connected();
    const int channels = field_ ? rules::channels({field}) : 3;
    coefficients_ = field.attribute("coefficients", 9);
    gaussians_ = field.attribute("basis", "sh") == "sg";
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    if (field_) ports.scratch("ambient", TextureDesc::image({1, 1}, Format::rgba32f), Access::image_read_write);
    resolution_.declare(ports, channels);
  }

  void prepare(Device& device, const Bindings&) override {
    mean_ = nullptr;
    if (field_)
      mean_ = device.program(
          {.files = {"ambient_occlusion/mean.comp"},
           .defines = {{"COEFFICIENTS", std::to_string(coefficients_)}, {"GAUSSIANS", gaussians_ ? "1" : "0"}}});
    resolution_.prepare(device, {.files = {"ambient_occlusion/open.comp"}, .defines = {{"FIELD", field_ ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    if (mean_) {
      frame.dispatch(*mean_, bindings, {1, 1, 1});
      frame.barrier();
    }
    resolution_.dispatch(frame, bindings);
  }

 private:
  glm::vec3 ambient_{0};
  int slices_ = 2;
  int steps_ = 12;
  float radius_ = 1;
  float thickness_ = .5F;
  int coefficients_ = 9;
  bool field_ = false, gaussians_ = false;
  Resolution resolution_;
  std::shared_ptr<const Program> mean_;
};

}  // namespace

LOOM_PLUGIN("ambient_occlusion", registry) {
  registry.add<AmbientOcclusion>("AmbientOcclusion", "Ambient light, as far as nothing near a pixel is in its way");
}
