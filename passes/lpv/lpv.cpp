// LPV: light propagation volumes (Kaplanyan and Dachsbacher 2010), with the flux kept.
//
// The cells of a grid hold intensity I(ω) [W/sr] as two-band SH. In each iteration a cell gathers from its six
// neighbours the flux through its own five far faces, Φ_face = I(ω_c)·Δω, and sends it on as a cosine lobe about the
// face's normal. Surfaces stand on the faces between cells: a face blocks the share B of the flux that crosses it, and
// B·ρ of it starts the next order of reflection, so that each order's gain is at most ρ < 1. With `blockers: sh` the
// share depends on the direction of travel instead, B(ω) in two SH bands at the corners of cells (the half-cell-shifted
// grid of the original): a full wall then blocks .75 of what meets it head-on, and its two faces each .5 of the rest.
//
// Propagation is a random walk: light needs about 2k² iterations to arrive k cells away. Nested grids (cascades)
// shorten the way; each is propagated on its own.
//
// Both methods run the same three stages on the same volumes: as compute shaders, or as fragment shaders whose targets
// are the layers of the volumes and which add up by blending.
#include "loom/plugin.h"
#include "loom/rules.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/grid.h"

namespace {

using namespace loom;

const std::array<std::string, 3> channels{"red", "green", "blue"};

// What OpenGL 4.5 guarantees for the side of a volume.
constexpr int max_slices = 2048;

class Lpv final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("iterations", iterations_, {.min = 0, .max = 1024, .scale = Scale::log, .doc = "steps of each order"});
    p.integer("bounces", bounces_, {.min = 1, .max = 16, .doc = "orders of reflection; 1 = the injected light alone"});
    p.choice("blockers", blockers_, {"faces", "sh"},
             {.cost = Cost::graph,
              .doc = "shares of the faces between cells, or a function of direction at their corners, which leaks"});
    p.choice("method", method_, {"compute", "fragment"},
             {.cost = Cost::graph, .doc = "shader stage that propagates; the results agree bit for bit"});
    p.choice("storage", storage_, {"fp32", "fp16"},
             {.cost = Cost::graph,
              .doc = "of what travels and of `intensity`; `fp16`: half the memory, 11 bits, and at most 65504 W/sr a "
                     "coefficient. Sums over steps stay in fp32: in halves they would stop growing"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto flux = ports.in("flux", "ShVolume").reads("red").reads("green").reads("blue");
    auto blockers = ports.in("blockers", "VoxelScene").optional().reads("occupancy").reads("albedo");
    const char* shares = blockers_ == "sh" ? "directional" : "occupancy";
    if (blockers_ == "sh") blockers.reads(shares);  // the albedo is still that of the faces
    auto intensity = ports.out("intensity", "ShVolume").attribute("bands", 2);
    if (flux.absent()) return intensity.absent(flux.why_absent());
    const TextureDesc* red = flux.texture("red");
    if (red == nullptr) return ports.error("lpv-flux", "the flux volume has no member `red`", "wire it to Inject");
    cascades_ = flux.attribute("cascades", 1);
    flux_channels_ = rules::channels({flux});
    channels_ = rules::channels({flux, blockers});
    cells_ = {red->width, red->height, red->depth / cascades_};
    if (channels_ * cells_.z > max_slices) {
      return ports.error("lpv-cells", std::to_string(cells_.z) + " cells deep, all channels exceed 2048 slices",
                         "use a coarser grid");
    }
    blocked_ = blockers.texture(shares) != nullptr && blockers.texture("albedo") != nullptr;
    if (blocked_ && !same_cells(*blockers.texture(shares), blockers.attribute("cascades", 1))) {
      return ports.error("lpv-grids", "flux and blockers are on different grids", "give both passes the same cells");
    }
    intensity.attribute("cascades", cascades_).attribute("channels", channels_);
    const Format stored = storage_ == "fp16" ? Format::rgba16f : Format::rgba32f;
    for (int i = 0; i < channels_; ++i) {
      TextureDesc desc = *red;
      desc.format = stored;
      intensity.texture(channels[static_cast<std::size_t>(i)], desc, Access::image_write);
    }

    const Access written = method_ == "fragment" ? Access::color : Access::image_read_write;
    for (const char* name : {"front0", "front1"}) ports.scratch(name, volume(stored, channels_), written);
    const TextureDesc state = volume(Format::rgba32f, channels_);
    ports.scratch("sum", state, written);
    if (blocked_) {
      ports.scratch("blocked", state, written);
      ports.scratch("open", volume(Format::rgba32ui, 1), Access::image_read_write);
      ports.scratch("reflect", volume(Format::rgba32ui, channels_), Access::image_read_write);
    } else {
      ports.decide("bounces", "one order", "no blockers are wired: nothing reflects");
    }
    // One empty cell at each end of the grid.
    const int cells_between = std::max({cells_.x, cells_.y, cells_.z}) - 2;
    most_bounces_ = rules::bounces(ports, rules::max_albedo(blockers));
    most_iterations_ = rules::iterations(ports, cells_between);
    if (blocked_) rules::decide_bounces(ports, rules::max_albedo(blockers), bounces_);
    rules::decide_iterations(ports, cells_between, iterations_);
    if (!facts.moves) ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const std::string file = method_ == "fragment" ? "lpv/stage.frag" : "lpv/stage.comp";
    const std::string row = cells_.x > 16 ? "32" : cells_.x > 8 ? "16" : "8";
    const std::string count = std::to_string(channels_), half = storage_ == "fp16" ? "1" : "0";
    const auto stage = [&](const char* name, const char* from, const char* to) {
      return device.program({.files = {file},
                             .defines = {{"CHANNELS", count},
                                         {"FLUX_CHANNELS", std::to_string(flux_channels_)},
                                         {"STAGE", name},
                                         {"BLOCKERS", blocked_ ? "1" : "0"},
                                         {"HALF", half},
                                         {"FROM", from},
                                         {"TO", to},
                                         {"ROW", row}}});
    };
    begin_ = stage("BEGIN", "scratch_front1", "scratch_front0");
    steps_ = {stage("STEP", "scratch_front0", "scratch_front1"), stage("STEP", "scratch_front1", "scratch_front0")};
    if (blocked_) {
      reflect_ = stage("REFLECT", "scratch_front0", "scratch_front1");
      walls_ = device.program({.files = {"lpv/walls.comp"},
                               .defines = {{"CHANNELS", count}, {"DIRECTIONAL", blockers_ == "sh" ? "1" : "0"}}});
    }
    const auto made = [&](const std::string& channel) { return bindings.has("intensity." + channel) ? "1" : "0"; };
    resolve_ = device.program(
        {.files = {"lpv/resolve.comp"},
         .defines = {{"RED", made("red")}, {"GREEN", made("green")}, {"BLUE", made("blue")}, {"HALF", half}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const auto grid = bindings.data<interop::Grid>("flux");
    if (blocked_) check_same_place(grid, bindings.data<interop::Grid>("blockers"));
    bindings.publish("intensity", grid);
    for (int cascade = 0; cascade < cascades_; ++cascade) {
      if (blocked_) {
        walls_->set("cascade", cascade);
        frame.dispatch(*walls_, bindings, cells_);
        frame.barrier();
      }
      for (int order = 0; order < (blocked_ ? std::min(bounces_, most_bounces_) : 1); ++order)
        propagate(frame, bindings, cascade, order);
      resolve_->set("cascade", cascade);
      frame.dispatch(*resolve_, bindings, cells_);
      frame.barrier();
    }
  }

  /// All that the result depends on comes in over the wires, which the executor watches.
  [[nodiscard]] Fingerprint fingerprint(const Frame& /*frame*/) const override { return 0; }

 private:
  using Members = std::vector<std::string_view>;

  void propagate(Frame& frame, const Bindings& bindings, int cascade, int order) const {
    begin_->set("cascade", cascade);
    begin_->set("order", order);
    run(frame, bindings, *begin_, {"scratch.front0", "scratch.sum"}, order == 0 ? 2 : 1);
    if (blocked_) run(frame, bindings, *reflect_, {"scratch.blocked"}, 1);
    for (int i = 0; i < std::min(iterations_, most_iterations_); ++i) {
      Members targets{i % 2 == 0 ? "scratch.front1" : "scratch.front0", "scratch.sum"};
      if (blocked_) targets.emplace_back("scratch.blocked");
      run(frame, bindings, *(i % 2 == 0 ? steps_[0] : steps_[1]), targets, 1);
    }
  }

  /// One stage over all cells and channels. Of its targets the first `replaced` are written, the others added to.
  void run(Frame& frame, const Bindings& bindings, const Program& program, const Members& targets, int replaced) const {
    if (method_ == "compute") {
      frame.dispatch(program, bindings, cells_ * glm::ivec3(1, 1, channels_));
    } else {
      frame.continue_raster(bindings, targets);
      for (int i = 0; i < static_cast<int>(targets.size()); ++i) {
        frame.blend(i, i < replaced ? Blend::replace : Blend::add);
      }
      frame.fullscreen(program, bindings);
    }
    frame.barrier();
  }

  [[nodiscard]] TextureDesc volume(Format format, int slabs) const {
    TextureDesc desc = TextureDesc::volume(cells_.x, format, Filter::nearest);
    desc.height = cells_.y;
    desc.depth = slabs * cells_.z;
    return desc;
  }

  [[nodiscard]] bool same_cells(const TextureDesc& shares, int cascades) const {
    return cascades == cascades_ && shares.width == cells_.x && shares.height == cells_.y &&
           shares.depth == cells_.z * cascades_;
  }

  /// Two passes may fit their grids in different ways; within a thousandth of a cell they are one grid.
  void check_same_place(const interop::Grid& flux, const interop::Grid& blockers) const {
    for (int k = 0; k < cascades_; ++k) {
      const glm::vec4 difference = glm::abs(flux.cascade[k] - blockers.cascade[k]);
      const float bound = 1e-3F * flux.cascade[k].w;
      const bool corner = std::max({difference.x, difference.y, difference.z}) <= bound;
      if (!corner || difference.w * static_cast<float>(cells_.x) > bound) {
        throw Error("LPV: flux and blockers are on different grids; wire both to one pass, or fit both alike");
      }
    }
  }

  int iterations_ = 16, bounces_ = 1;
  int most_iterations_ = 0, most_bounces_ = 1;  ///< that this grid and this scene take
  std::string method_ = "compute", blockers_ = "faces", storage_ = "fp32";
  glm::ivec3 cells_{1};
  int cascades_ = 1, channels_ = 3, flux_channels_ = 3;
  bool blocked_ = false;
  std::shared_ptr<const Program> begin_, reflect_, walls_, resolve_;
  std::array<std::shared_ptr<const Program>, 2> steps_;  // from the first front to the second, and back
};

}  // namespace

LOOM_PLUGIN("lpv", registry) {
  registry.add<Lpv>("LPV", "Propagates injected flux through a grid, with blockers and orders of reflection");
}
