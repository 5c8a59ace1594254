// Accumulate: the mean of irradiance over frames, kept with the surface while the camera moves,
//
//   E_N = E_{N−1} + (e − E_{N−1})/N,    N = min(N_last + 1, max_history),
//
// e what this frame brings. As long as N grows this is the mean of all N frames: noise that is independent from frame
// to frame loses its variance as 1/N. At N = M = max_history it goes on as an exponential mean with α = 1/M, whose
// variance is α/(2−α) of the source's; what is out of date then fades by (1−α) a frame.
//
// The last frame comes over history wires: `"last": "accumulate.irradiance@prev"`, `"last_length":
// "accumulate.length@prev"` (N of each pixel), `"last_surface": "gbuffer.surface@prev"`. It is read where its camera
// saw the surface point x: at the pixel plus (s' − s)·size/2, s and s' the image-plane coordinates of x in both cameras
// without their sub-pixel shifts. So a camera at rest reads its own texel, to the bit, and under `--samples` the mean
// is over the pixel's area. Otherwise it is the bilinear mean over those of the four texels that show the same surface:
// shading normals within `normal_angle`, and neither point farther from the plane of the other's triangle than
// `plane_distance` pixel footprints. Where none is left (disocclusion, image border, reset) N begins with 1. That is
// the bound on ghosts: nothing crosses from one surface to another beyond these tolerances. Repeated bilinear reads
// blur along the surface: a step of them has a variance of ¼ pixel² at most in each direction, and the frames of the
// mean are M − 1 steps old on average at most, so that it is √M/2 pixels at worst.
//
// Only the camera is followed. Objects that move are rejected where they leave their plane; where light changes on a
// surface at rest, a share of (1 − 1/N) of the old value is left after each frame.
#include <memory>
#include <string>

#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class Accumulate final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("max_history", max_history_,
              {.min = 1,
               .max = 65536,
               .unit = "frames",
               .scale = Scale::log,
               .doc = "M: frames of the mean; more keeps less noise and follows changing light more slowly"});
    p.real("plane_distance", plane_distance_,
           {.min = .01,
            .max = 100,
            .unit = "pixel footprints",
            .scale = Scale::log,
            .doc = "how far the last frame's point may lie from the surface's plane"});
    p.real("normal_angle", normal_angle_,
           {.min = 0, .max = 180, .unit = "degrees", .doc = "how far the last frame's normal may be turned"});
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    const auto noisy = ports.in("noisy", "Irradiance").reads("irradiance");
    const auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    ports.in("last", "Irradiance").reads("irradiance");
    ports.in("last_length", "Image").reads("image");
    ports.in("last_surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    auto irradiance = ports.out("irradiance", "Irradiance");
    auto length = ports.out("length", "Image");
    if (noisy.absent() || surface.absent()) {
      const std::string why = noisy.absent() ? noisy.why_absent() : surface.why_absent();
      irradiance.absent(why);
      length.absent(why);
      return;
    }
    const int channels = rules::channels({noisy});
    irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels),
                       Access::image_write);
    irradiance.attribute("channels", channels);
    irradiance.attribute("quantity", "irradiance");
    length.texture("image", TextureDesc::image(ports.frame_size(), Format::r32f), Access::image_write);
    length.attribute("quantity", "frames");
  }

  void prepare(Device& device, const Bindings&) override {
    program_ = device.program({.files = {"accumulate/accumulate.comp"}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    program_->set("has_history", bindings.history_valid("last") && bindings.history_valid("last_surface") ? 1 : 0);
    frame.dispatch(*program_, bindings, {frame.size(), 1});
  }

 private:
  int max_history_ = 64;
  float plane_distance_ = 1;
  float normal_angle_ = 25;
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("accumulate", registry) {
  registry.add<Accumulate>("Accumulate", "Mean of irradiance over frames, followed through the camera's motion");
}
