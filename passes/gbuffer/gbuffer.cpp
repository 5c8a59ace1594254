// The nearest surface at each pixel, by one rasterised pass into as many targets as are read.
//   depth             distance along the camera ray, metres; 0 where nothing is seen
//   normal            unit shading normal (normal map included), world, on the viewer's side of the triangle
//   geometric_normal  unit normal of the triangle, world, towards the viewer
//   albedo            ρ = baseColor·(1−metallic)·(1−transmission), textures and vertex colours included
//   emission          exitant radiance towards the viewer, W/(m² sr)
//   specular          rgb: F₀, reflectance along the normal; a: α = roughness² of GGX; where a surface is glossy
//
//   transmission      r: share of the dielectric's light that is refracted, g: its index; where a surface is glass
//
// Nothing is culled; masked materials are cut by their alpha; the back of a single-sided face does not emit. The bundle
// struct is the camera, its sub-pixel shift included.
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "interop/camera.h"
#include "loom/facts.h"
#include "loom/fingerprint.h"
#include "loom/formats.h"
#include "loom/frame.h"
#include "loom/gpu.h"
#include "loom/pass.h"
#include "loom/plugin.h"
#include "loom/ports.h"
#include "loom/rules.h"
#include "loom/scene_view.h"

namespace {

using namespace loom;  // NOLINT(google-build-using-namespace): a plugin is all about these names

struct Member {
  std::string_view path;
  std::string_view name;
  Format format;
  const char* define;
  bool color = false;
};
// Half floats: a unit vector's component is off by 2⁻¹¹ at most (a slope of .03°; drivers may round or cut off), an
// albedo by 2⁻¹¹ of itself, also where it is dark. Depth rebuilds positions and emission may be 1e6 W/(m² sr), beyond
// half floats: both keep all 24 bits.
constexpr std::array<Member, 7> members{{
    {"surface.depth", "depth", Format::r32f, "DEPTH"},
    {"surface.normal", "normal", Format::rgba16f, "NORMAL"},
    {"surface.geometric_normal", "geometric_normal", Format::rgba16f, "GEOMETRIC_NORMAL"},
    {"surface.albedo", "albedo", Format::rgba16f, "ALBEDO", true},
    {"surface.emission", "emission", Format::rgba32f, "EMISSION", true},
    {"surface.specular", "specular", Format::rgba16f, "SPECULAR"},
    {"surface.transmission", "transmission", Format::rg16f, "TRANSMISSION"},
}};

class GBuffer final : public Pass {
 public:
  void reflect(Ports& ports, const SceneFacts& facts) override {
    const auto size = ports.frame_size();
    const bool emission = facts.emissive_triangles > 0 || !ports.rule("no-emission");
    const bool specular = facts.specular || (facts.ggx && !ports.rule("no-specular"));
    const int channels = rules::channels(ports, facts);
    auto surface = ports.out("surface", "Surface").attribute("channels", channels);
    targets_.clear();
    for (const Member& member : members) {
      if (member.name == "emission" && !emission) continue;
      if (member.name == "specular" && !specular) continue;
      if (member.name == "transmission" && !facts.transmission) continue;
      const TextureDesc desc = TextureDesc::image(size, member.format);
      targets_.push_back(&member);
      surface.texture(member.name, member.color ? desc.with_channels(channels) : desc, Access::color);
    }
    ports.scratch("depth", TextureDesc::image(size, Format::depth32f), Access::depth);
    if (!emission) ports.decide("no-emission", "no emission is written", "no surface emits");

    if (facts.ggx && !specular) {
      ports.decide("no-specular", "no specular reflectance is written", "every surface is matte");
    }

    facts_ = facts;
    if (!facts.normal_maps) {
      facts_.normal_maps = !ports.rule("no-normal-map");
      if (!facts_.normal_maps) ports.decide("no-normal-map", "no tangents are read", "no material has a normal map");
    }
    if (!facts.alpha_mask) {
      facts_.alpha_mask = !ports.rule("no-alpha");
      if (!facts_.alpha_mask) ports.decide("no-alpha", "nothing is discarded", "no material is masked");
    }
    if (!facts.moves) ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    SceneFacts opaque = facts_;
    opaque.alpha_mask = false;
    opaque_ = program_of(device, bindings, opaque);
    masked_ = facts_.alpha_mask ? program_of(device, bindings, facts_) : nullptr;
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    frame.begin_raster(bindings);
    frame.bind(*opaque_, bindings);
    frame.scene().draw(*opaque_, 1, Surfaces::opaque);
    if (masked_) {
      frame.bind(*masked_, bindings);
      frame.scene().draw(*masked_, 1, Surfaces::masked);
    }
    bindings.publish("surface", frame.camera());
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return mix_in(frame.scene().geometry_version(), frame.camera());
  }

 private:
  std::shared_ptr<const Program> program_of(Device& device, const Bindings& bindings, const SceneFacts& facts) const {
    ProgramDesc desc{.files = {"gbuffer/gbuffer.vert", "gbuffer/gbuffer.frag"}, .defines = scene_defines(facts)};
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      if (bindings.has(targets_[i]->path)) desc.defines.emplace_back(targets_[i]->define, std::to_string(i));
    }
    return device.program(desc);
  }

  SceneFacts facts_;
  std::vector<const Member*> targets_;              ///< declared ones: the order in which they are attached
  std::shared_ptr<const Program> opaque_, masked_;  ///< masked_ is null where nothing is
};

}  // namespace

LOOM_PLUGIN("gbuffer", registry) {
  registry.add<GBuffer>("GBuffer", "The nearest surface at each pixel: depth, normals, albedo, emission");
}
