// Radiosity: the light that the surfaces of a voxelized scene reflect, order by order.
//
// R₁ is what every side of every sheet reflects of straight light (Voxelize). Each further order gathers over
// cosine-distributed rays through the voxels, the equation of radiosity by Jacobi's iteration (Goral et al. 1984),
//   R_{i+1} = R₁ + ρ/π·E[R_i],   E = π/N · Σ R_i(ω_k),
// so that R_n holds all light after 1 … n reflections; what is missing is of order ρⁿ⁺¹. With the last frame's result
// wired back (`last`, a history wire) a frame goes on from there, and the orders add up over frames: each frame's gain
// is the mean albedo, below 1, so that it converges.
#include "loom/plugin.h"
#include "loom/rounds.h"
#include "loom/rules.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "interop/grid.h"

namespace {

using namespace loom;

class Radiosity final : public Pass {
 public:
  void params(Params& p) override {
    p.integer(
        "bounces", bounces_,
        {.min = 1,
         .max = 32,
         .cost = Cost::graph,
         .doc = "orders of reflection; 1 = what straight light alone makes. With `last`: the orders that one frame "
                "adds, and one"});
    p.integer("rays", rays_, {.min = 1, .max = 1024, .scale = Scale::log, .doc = "rays a side of a sheet and order"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto voxels = ports.in("voxels", "VoxelScene").reads("coverage").reads("plane").reads("extent");
    voxels.reads("centroid").reads("albedo").reads("radiance");
    auto last = ports.in("last", "VoxelScene").optional().reads("radiance");
    auto light = ports.out("light", "VoxelScene");
    const TextureDesc* radiance = voxels.texture("radiance");
    if (voxels.absent()) return light.absent(voxels.why_absent());
    if (radiance == nullptr) return light.absent("the voxels carry no radiance");
    half_ = radiance->format == Format::rgba16f || radiance->format == Format::r16f;
    grey_ = voxels.attribute("channels", 3) == 1;
    light.attribute("channels", grey_ ? 1 : 3);
    light.texture("radiance", *radiance, Access::image_read_write).needed("radiance");
    ports.scratch("radiance", *radiance, Access::image_write);
    feedback_ = last.connected();
    orders_ = bounces_;
    if (!feedback_) {
      orders_ = std::min(bounces_, rules::bounces(ports, rules::max_albedo(voxels)));
      rules::decide_bounces(ports, rules::max_albedo(voxels), bounces_);
    }
    if (!facts.moves && !feedback_ && ports.rule("static")) {
      ports.keep_outputs();
      ports.decide("static", "reflected light is found once", "nothing in the scene moves");
    }
  }

  void prepare(Device& device, const Bindings& /*bindings*/) override {
    const auto program = [&](const char* file, const char* source, const char* target) {
      return device.program(
          {.files = {file}, .defines = {{"SOURCE", source}, {"TARGET", target}, {"HALF", half_ ? "1" : "0"}}});
    };
    // The last order goes to the output, so that the one before it is in the scratch volume.
    copy_first_ = program("radiosity/copy.comp", "voxels_radiance", "scratch_radiance");
    copy_last_ = feedback_ ? program("radiosity/copy.comp", "last_radiance", "scratch_radiance") : nullptr;
    copy_order_ = orders_ > 2 ? program("radiosity/copy.comp", "light_radiance", "scratch_radiance") : nullptr;
    copy_through_ = orders_ == 1 ? program("radiosity/copy.comp", "scratch_radiance", "light_radiance") : nullptr;
    gather_ = nullptr;
    if (orders_ > 1)
      gather_ = device.program({.files = {"radiosity/gather.comp"},
                                .defines = {{"SOURCE", "scratch_radiance"},
                                            {"TARGET", "light_radiance"},
                                            {"HALF", half_ ? "1" : "0"},
                                            {"FORMAT", grey_ ? "STORAGE_R" : "STORAGE_RGBA"},
                                            {"CHANNELS(texel)", grey_ ? "texel.rrr" : "texel.rgb"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const auto grid = bindings.data<interop::Grid>("voxels");
    bindings.publish("light", grid);
    const glm::ivec3 sides(grid.cells.x, grid.cells.y, 6 * grid.cells.z);
    const bool resume = copy_last_ && bindings.history_valid("last");
    frame.dispatch(resume ? *copy_last_ : *copy_first_, bindings, sides);
    frame.barrier();
    if (copy_through_) frame.dispatch(*copy_through_, bindings, sides);
    for (int order = 2; order <= orders_; ++order) {
      gather_->set("order", order);
      // Where orders add up over frames, each frame has rays of its own.
      gather_->set("frame_seed", feedback_ ? static_cast<unsigned int>(frame.info().index) : 0U);
      const int at_once = steps_at_once(rays_, rounds_of_marched_ray(grid.cells.x + grid.cells.y + grid.cells.z));
      for (int first = 0; first < rays_; first += at_once) {
        gather_->set("part", glm::ivec2(first, std::min(first + at_once, rays_)));
        frame.dispatch(*gather_, bindings, sides);
        frame.barrier();
      }
      if (order < orders_) frame.dispatch(*copy_order_, bindings, sides);
      frame.barrier();
    }
  }

  /// Geometry and lights come in over the wires; the rays depend on the seed alone.
  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override { return frame.info().seed; }

 private:
  int bounces_ = 8, rays_ = 16;
  int orders_ = 1;
  bool feedback_ = false, grey_ = false, half_ = false;
  std::shared_ptr<const Program> copy_first_, copy_last_, copy_order_, copy_through_, gather_;
};

}  // namespace

LOOM_PLUGIN("radiosity", registry) {
  registry.add<Radiosity>("Radiosity", "Orders of reflection among the surfaces of a voxelized scene");
}
