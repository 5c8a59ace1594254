// LPV: light propagation volumes (Kaplanyan and Dachsbacher 2010), with the flux kept.
//
// The cells of a grid hold intensity I(ω) [W/sr] as two-band SH. In each iteration a cell gathers from its six
// neighbours the flux through its own five far faces, Φ_face = I(ω_c)·Δω, and sends it on as a cosine lobe about the
// face's normal. Surfaces stand on the faces between cells: a face blocks the share B of the flux that crosses it, and
// B·ρ of it starts the next order of reflection, so that each order's gain is at most ρ < 1.
//
// Propagation is a random walk: light needs about 2k² iterations to arrive k cells away.
#include "loom/plugin.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "interop/grid.h"

namespace {

using namespace loom;

const std::array<std::string, 3> channels{"red", "green", "blue"};

class Lpv final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("iterations", iterations_, {.min = 0, .max = 1024, .scale = Scale::log, .doc = "steps of each order"});
    p.integer("bounces", bounces_, {.min = 1, .max = 16, .doc = "orders of reflection; 1 = the injected light alone"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto flux = ports.in("flux", "ShVolume").reads("red").reads("green").reads("blue");
    auto blockers = ports.in("blockers", "VoxelScene").optional().reads("occupancy").reads("albedo");
    auto intensity = ports.out("intensity", "ShVolume").attribute("bands", 2);
    if (flux.absent()) return intensity.absent(flux.why_absent());
    const TextureDesc* red = flux.texture("red");
    if (red == nullptr) return ports.error("lpv-flux", "the flux volume has no member `red`", "wire it to Inject");
    cells_ = static_cast<std::size_t>(red->width) * red->height * red->depth;
    blocked_ = blockers.texture("occupancy") != nullptr && blockers.texture("albedo") != nullptr;
    for (const std::string& channel : channels) intensity.texture(channel, *red, Access::image_write);

    ports.scratch("front", BufferDesc{.bytes = 2 * 4 * cells_ * sizeof(glm::vec4)});
    ports.scratch("sum", BufferDesc{.bytes = 3 * cells_ * sizeof(glm::vec4)});
    ports.scratch("blocked", BufferDesc{.bytes = 3 * cells_ * sizeof(glm::vec4)});
    if (!blocked_) ports.decide("bounces", "one order", "no blockers are wired: nothing reflects");
    if (!facts.moves) ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const std::vector<Define> defines = {{"BLOCKERS", blocked_ ? "1" : "0"}};
    begin_ = device.program({.files = {"lpv/begin.comp"}});
    propagate_ = device.program({.files = {"lpv/propagate.comp"}, .defines = defines});
    resolve_.clear();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (!bindings.has("intensity." + channels[i])) continue;
      resolve_.push_back(
          device.program({.files = {"lpv/resolve.comp"},
                          .defines = {{"VOLUME", "intensity_" + channels[i]}, {"CHANNEL", std::to_string(i)}}}));
    }
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const auto grid = bindings.data<interop::Grid>("flux");
    bindings.publish("intensity", grid);
    const glm::ivec3 cells(grid.cells);
    for (int order = 0; order < (blocked_ ? bounces_ : 1); ++order) {
      begin_->set("order", order);
      frame.dispatch(*begin_, bindings, {static_cast<int>(cells_), 1, 1});
      frame.barrier();
      for (int i = 0; i < iterations_; ++i) {
        propagate_->set("source_half", i & 1);
        frame.dispatch(*propagate_, bindings, cells);
        frame.barrier();
      }
    }
    for (const auto& resolve : resolve_) frame.dispatch(*resolve, bindings, cells);
  }

  /// All that the result depends on comes in over the wires, which the executor watches.
  [[nodiscard]] Fingerprint fingerprint(const Frame& /*frame*/) const override { return 0; }

 private:
  int iterations_ = 16, bounces_ = 1;
  std::size_t cells_ = 0;
  bool blocked_ = false;
  std::shared_ptr<const Program> begin_, propagate_;
  std::vector<std::shared_ptr<const Program>> resolve_;  // of the channels that are read
};

}  // namespace

LOOM_PLUGIN("lpv", registry) {
  registry.add<Lpv>("LPV", "Propagates injected flux through a grid, with blockers and orders of reflection");
}
