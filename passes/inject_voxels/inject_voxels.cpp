// InjectVoxels: the voxelized scene as flux and blockers, for light propagation.
//
// Every side of every sheet (Voxelize) reflects radiance R from the area A that it shows. It is an emitter of flux
// Φ = π·R·A [W] about its normal n, in the cell half a cell off it: I(ω) += Φ/π·⟨n,ω⟩₊ as two-band SH. And it blocks,
// along each axis e, the cell face nearest to it by A·|⟨n,e⟩|/s². All surfaces count, seen by a light or a camera or
// not.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "interop/grid.h"
#include "loom/grid.h"
#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

class InjectVoxels final : public Pass {
 public:
  void params(Params& p) override {
    p.choice(
        "storage", storage_, {"fp32", "fp16"},
        {.cost = Cost::graph,
         .doc = "of flux and blocked shares; `fp16`: half the memory, 11 bits, and at most 65504 W/sr a coefficient"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto voxels = ports.in("voxels", "VoxelScene").reads("coverage").reads("plane").reads("extent");
    voxels.reads("centroid").reads("albedo").reads("radiance");
    auto flux = ports.out("flux", "ShVolume").attribute("bands", 2).attribute("cascades", 1);
    auto blockers = ports.out("blockers", "VoxelScene").attribute("cascades", 1);
    channels_ = rules::channels({voxels});
    flux.attribute("channels", channels_);
    blockers.attribute("channels", channels_).attribute("max_albedo", rules::max_albedo(voxels));
    const TextureDesc* cells = voxels.texture("coverage");
    if (cells == nullptr) {
      const std::string why = voxels.absent() ? voxels.why_absent() : "the voxels carry no sheets";
      flux.absent(why);
      return blockers.absent(why);
    }
    TextureDesc desc = *cells;
    desc.format = storage_ == "fp16" ? Format::rgba16f : Format::rgba32f;
    blockers.texture("occupancy", desc, Access::image_write).needed("occupancy");
    desc.filter = Filter::linear;
    static constexpr std::array<const char*, 3> names{"red", "green", "blue"};
    for (const char* channel : std::span(names).first(static_cast<std::size_t>(channels_)))
      flux.texture(channel, desc, Access::image_write).needed(channel);
    desc = *cells;
    desc.format = Format::rgba16f;
    desc.depth *= 3;  // one slab a face axis
    blockers.texture("albedo", desc.with_channels(channels_), Access::image_write);
    if (!facts.moves && ports.rule("static")) ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const Define half{"HALF", storage_ == "fp16" ? "1" : "0"};
    flux_ = device.program(
        {.files = {"inject_voxels/flux.comp"}, .defines = {{"CHANNELS", std::to_string(channels_)}, half}});
    blockers_ = device.program({.files = {"inject_voxels/blockers.comp"},
                                .defines = {{"ALBEDO", bindings.has("blockers.albedo") ? "1" : "0"}, half}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const auto grid = bindings.data<interop::Grid>("voxels");
    bindings.publish("flux", grid);
    bindings.publish("blockers", grid);
    frame.dispatch(*flux_, bindings, glm::ivec3(grid.cells));
    frame.dispatch(*blockers_, bindings, glm::ivec3(grid.cells));
  }

  /// All that the result depends on comes in over the wire, which the executor watches.
  [[nodiscard]] Fingerprint fingerprint(const Frame& /*frame*/) const override { return 0; }

 private:
  int channels_ = 3;
  std::string storage_ = "fp32";
  std::shared_ptr<const Program> flux_, blockers_;
};

}  // namespace

LOOM_PLUGIN("inject_voxels", registry) {
  registry.add<InjectVoxels>("InjectVoxels", "The voxelized scene as flux and face blockers, for light propagation");
}
