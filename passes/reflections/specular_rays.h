#pragma once
// What Reflections and Refraction share: a picture, voxels and the sky as what rays bring, and rays shared out over
// dispatches.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "loom/plugin.h"
#include "loom/rounds.h"
#include "loom/rules.h"

namespace loom {

class SpecularRays : public Pass {
 public:
  void params(Params& p) override {
    p.integer("samples", samples_,
              {.min = 1,
               .max = 1024,
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "rays a pixel; smooth surfaces take one"});
    p.integer("steps", steps_,
              {.min = 2,
               .max = 2048,
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "texels of the picture that a ray reads at most; every one that it crosses where these suffice, "
                      "else denser near its origin"});
    p.real("thickness", thickness_,
           {.min = 1e-4,
            .max = 1e6,
            .unit = "m",
            .scale = Scale::log,
            .doc = "how far what is seen goes on behind its surface: a ray in there is lost, one behind it passes on"});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    for (int part = 0; part < parts_; ++part) {
      if (part > 0) frame.barrier();
      program_->set("part", glm::ivec2(part, parts_));
      frame.dispatch(*program_, bindings, {frame.size(), 1});
    }
  }

 protected:
  /// Declares all ports. `member` of the surface: without it there is nothing to do, and `why` says so. `traced`: rays
  /// against the BVH for each of a pixel.
  void declare(Ports& ports, const SceneFacts& facts, const char* member, const char* why, int traced) {
    auto surface = ports.in("surface", "Surface").reads("depth").reads("normal").reads("geometric_normal");
    surface.reads("specular").reads("transmission");
    const auto picture = ports.in("picture", "Image").optional().reads("image");
    auto voxels = ports.in("voxels", "VoxelScene").optional().reads("coverage").reads("plane").reads("extent");
    voxels.reads("radiance").reads("emission");
    const auto light = ports.in("light", "VoxelScene").optional().reads("radiance");
    auto radiance = ports.out("radiance", "Image").attribute("quantity", "radiance");
    auto ends = ports.out("ends", "Image").attribute("quantity", "shares of rays");
    if (surface.absent() || surface.texture(member) == nullptr) {
      const std::string absent = surface.absent() ? surface.why_absent() : why;
      radiance.absent(absent);
      return ends.absent(absent);
    }
    picture_ = !picture.absent();
    emission_ = voxels.texture("emission") != nullptr;
    const bool straight = voxels.texture("radiance") != nullptr;
    light_ = light.texture("radiance") != nullptr ? "light_radiance" : straight ? "voxels_radiance" : "";
    voxels_ = !voxels.absent() && (emission_ || !light_.empty());
    transmission_ = surface.texture("transmission") != nullptr;
    sky_image_ = facts.sky_image;
    // The sky, and F₀, are the scene's.
    const int channels = std::max(rules::channels({picture, voxels, light}), rules::channels(ports, facts));
    const auto image = TextureDesc::image(ports.frame_size(), Format::rgba32f);
    radiance.texture("image", image.with_channels(channels), Access::image_write);
    radiance.attribute("channels", channels);
    ends.texture("image", image, Access::image_write);
    int rounds = picture_ ? steps_ : 1;
    if (const TextureDesc* cells = voxels.texture("coverage"))
      rounds += rounds_of_marched_ray(cells->width + cells->height + cells->depth);
    rounds = traced * rounds_of_traced_ray + std::max(1, traced) * rounds;
    parts_ = parts_of(samples_, rounds);
    if (parts_ == 1) return;
    ports.scratch("sum", image, Access::image_read_write);
    ports.scratch("ends", image, Access::image_read_write);
  }

  void compile(Device& device, const Bindings& bindings, const std::string& file, std::vector<Define> defines = {}) {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    defines.insert(defines.end(), {{"PICTURE", flag(picture_)},
                                   {"VOXELS", flag(voxels_)},
                                   {"EMISSION", flag(emission_)},
                                   {"TRANSMISSION", flag(transmission_)},
                                   {"PARTS", flag(parts_ > 1)},
                                   {"RADIANCE", flag(bindings.has("radiance.image"))},
                                   {"ENDS", flag(bindings.has("ends.image"))}});
    if (sky_image_) defines.emplace_back("SCENE_SKY_IMAGE", "1");
    if (!light_.empty()) defines.emplace_back("LIGHT", light_);
    program_ = device.program({.files = {file}, .defines = std::move(defines)});
  }

  int samples_ = 8, steps_ = 256;
  float thickness_ = .5F;

 private:
  int parts_ = 1;
  bool picture_ = false, voxels_ = false, emission_ = false, transmission_ = false, sky_image_ = false;
  std::string light_;  ///< sampler of what sheets reflect; empty where nothing lights them
  std::shared_ptr<const Program> program_;
};

}  // namespace loom
