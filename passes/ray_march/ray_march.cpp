// RayMarch: irradiance by marching through the voxelized scene.
//
//   E(x) = ∫ L(ω)⟨n,ω⟩₊ dω ≈ π/N · Σ L(ω_i),   ω_i with density cosθ/π,
//
// L what the sheets on the way send back, each weighted by the share of the ray that reaches it (DDA through partial
// occupancy, shaders/lib/voxels.glsl). The sheets send what they reflect: of all orders where `light` is wired
// (Radiosity), else of straight light alone. Three ways, from dear to cheap:
//   rays    from every pixel (`irradiance`), and of those some aimed at what shines most: a lit shade around a lamp is
//           small, and met by chance it makes speckles (shaders/ray_march/aim.glsl);
//   cones   from every pixel, over a pyramid of ever coarser cells: no noise, but blocked too early;
//   volume  rays from the cells of a coarse grid, as two-band SH for GatherVolume (`volume`): independent of the
//   picture. Of these cells only those that the pixels of `readers` read, where it is wired: the others sleep, and hold
//   0.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/grid.h"
#include "loom/fingerprint.h"
#include "loom/grid.h"
#include "loom/plugin.h"
#include "loom/resolution.h"
#include "loom/rounds.h"
#include "loom/rules.h"

namespace {

using namespace loom;

/// Sides of sheets that the aimed rays of one frame go to.
constexpr std::size_t targets = 4096;

class RayMarch final : public Pass {
 public:
  void params(Params& p) override {
    p.choice("method", method_, {"rays", "cones"}, {.cost = Cost::graph, .doc = "how `irradiance` is found"});
    p.integer(
        "rays", rays_,
        {.min = 1, .max = 4096, .scale = Scale::log, .cost = Cost::graph, .doc = "rays a pixel and frame, or a probe"});
    p.integer("aimed", aimed_,
              {.min = 0,
               .max = 4096,
               .cost = Cost::graph,
               .doc = "rays a pixel and frame besides, aimed at the sheets that shine most"});
    p.integer("cones", cones_, {.min = 4, .max = 256, .scale = Scale::log, .doc = "cones a pixel"});
    p.integer("probes", probes_,
              {.min = 1,
               .max = 64,
               .unit = "cells",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "cells of `volume` along the longest side of the scene's box"});
    p.choice("storage", storage_, {"fp32", "fp16"},
             {.cost = Cost::graph,
              .doc = "of `volume` and of what cones go through; `fp16`: half the memory, 11 bits, and at most 65504"});
    p.boolean(
        "emitter", emitter_,
        {.cost = Cost::graph,
         .doc = "count what comes straight from emissive surfaces and sky, too: for pipelines without AreaLight"});
    resolution_.params(p);
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto surface = ports.in("surface", "Surface").optional();
    surface.reads("depth").reads("normal").reads("geometric_normal");
    auto voxels = ports.in("voxels", "VoxelScene").reads("coverage").reads("plane").reads("extent");
    if (method_ == "cones") voxels.reads("centroid").reads("albedo");
    voxels.reads("radiance");
    if (emitter_) voxels.reads("emission");
    auto light = ports.in("light", "VoxelScene").optional().reads("radiance");
    auto readers = ports.in("readers", "Surface").optional().reads("depth").reads("normal");
    auto irradiance = ports.out("irradiance", "Irradiance").attribute("quantity", "irradiance");
    auto volume = ports.out("volume", "ShVolume").attribute("bands", 2).attribute("cascades", 1);
    sky_image_ = facts.sky_image;
    has_light_ = light.texture("radiance") != nullptr;
    // With `emitter` rays that leave the scene bring the sky, which is the scene's own.
    channels_ = std::max(rules::channels({voxels, light}), emitter_ ? rules::channels(ports, facts) : 1);
    irradiance.attribute("channels", channels_);
    volume.attribute("channels", channels_);
    if (voxels.absent() || (!has_light_ && voxels.texture("radiance") == nullptr)) {
      const std::string why = voxels.absent() ? voxels.why_absent() : "the voxels carry no radiance";
      irradiance.absent(why);
      return volume.absent(why);
    }
    emission_ = emitter_ && voxels.texture("emission") != nullptr;
    if (const TextureDesc* coverage = voxels.texture("coverage"))
      rounds_of_ray_ = rounds_of_marched_ray(coverage->width + coverage->height + coverage->depth);
    if (surface.absent()) {
      irradiance.absent(surface.connected() ? surface.why_absent() : "no surface is wired");
    } else {
      irradiance.texture("irradiance", TextureDesc::image(ports.frame_size(), Format::rgba32f).with_channels(channels_),
                         Access::image_write);
      resolution_.declare(ports, channels_, method_ == "rays" ? parts_of(rays_ + aimed_, rounds_of_ray_) : 1);
    }

    probe_grid_ = fit_grid(rules::bounds(ports, facts), probes_);
    const Format stored = storage_ == "fp16" ? Format::rgba16f : Format::rgba32f;
    TextureDesc cells = cell_texture(probe_grid_, stored);
    cells.filter = Filter::linear;
    static constexpr std::array<const char*, 3> names{"red", "green", "blue"};
    for (const char* channel : std::span(names).first(static_cast<std::size_t>(channels_)))
      volume.texture(channel, cells, Access::image_read_write);

    if (const TextureDesc* coverage = voxels.texture("coverage")) {
      if (method_ == "cones") {
        scratch_levels(ports, "pyramid", *coverage, stored, 6);
      } else if (aimed_ > 0) {
        scratch_levels(ports, "power", *coverage, Format::r32f, 1);
        ports.scratch("targets", BufferDesc{(1 + targets) * sizeof(glm::ivec4)});
      }
    }
    sleeps_ = !readers.absent() && ports.rule("sleeping-probes");
    if (surface.absent() && !facts.moves) ports.keep_outputs(sleeps_ ? Keep::parts : Keep::whole);
    if (!sleeps_) return;
    ports.persistent("cells", cell_texture(probe_grid_, Format::r32ui), Access::image_read_write);
    ports.decide("sleeping-probes", "cells of the volume that no pixel reads send no rays",
                 "`readers` is wired: GatherVolume reads the eight cells around a point");
  }

  void prepare(Device& device, const Bindings& bindings) override {
    std::vector<Define> defines{{"LIGHT", has_light_ ? "light_radiance" : "voxels_radiance"},
                                {"EMITTER", emitter_ ? "1" : "0"},
                                {"EMISSION", emission_ ? "1" : "0"},
                                {"AIMED", aimed_ > 0 ? "1" : "0"},
                                {"HALF", storage_ == "fp16" ? "1" : "0"},
                                {"SLEEPS", sleeps_ ? "1" : "0"},
                                {"CHANNELS", std::to_string(channels_)}};
    if (emitter_ && sky_image_) defines.emplace_back("SCENE_SKY_IMAGE", "1");
    const auto program = [&](const char* file) { return device.program({.files = {file}, .defines = defines}); };
    base_ = reduce_ = draw_ = wake_ = volume_ = nullptr;
    pixels_ = bindings.has("irradiance.irradiance");
    if (pixels_) {
      const bool cones = method_ == "cones";
      resolution_.prepare(device,
                          {.files = {cones ? "ray_march/cones.comp" : "ray_march/march.comp"}, .defines = defines});
      if (cones) {
        base_ = program("ray_march/pyramid_base.comp");
        reduce_ = program("ray_march/pyramid_reduce.comp");
      } else if (aimed_ > 0) {
        base_ = program("ray_march/power_base.comp");
        reduce_ = program("ray_march/power_reduce.comp");
        draw_ = program("ray_march/draw_targets.comp");
      }
    }
    if (!bindings.has("volume.red")) return;
    if (sleeps_) wake_ = program("ray_march/wake.comp");
    volume_ = program("ray_march/volume.comp");
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    if (base_) build_levels(frame, bindings);
    if (pixels_) resolution_.dispatch(frame, bindings);
    if (!volume_) return;
    bindings.publish("volume", probe_grid_);
    if (wake_) wake(frame, bindings);
    const int at_once = steps_at_once(rays_, rounds_of_ray_);
    for (int first = 0; first < rays_; first += at_once) {
      volume_->set("part", glm::ivec2(first, std::min(first + at_once, rays_)));
      frame.dispatch(*volume_, bindings, glm::ivec3(probe_grid_.cells));
      frame.barrier();
    }
  }

  /// Geometry and lights come in over the wires, but for the sky; the rays depend on the seed alone.
  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return emitter_ ? mix_in(frame.info().seed, frame.scene().lights_version()) : frame.info().seed;
  }

 private:
  /// Finds the cells that a pixel reads. Those that sent their rays keep what came of it, until the rays, or what they
  /// meet, are others.
  void wake(Frame& frame, const Bindings& bindings) {
    std::uint64_t rays = mix_in(mix_in(frame.info().seed, rays_), bindings.revision("voxels"));
    if (has_light_) rays = mix_in(rays, bindings.revision("light"));
    if (!bindings.kept() || marched_ != rays) bindings.texture("persistent.cells").clear(glm::vec4(0));
    marched_ = rays;
    frame.dispatch(*wake_, bindings, {frame.size(), 1});
    frame.barrier();
  }

  static glm::ivec3 level_cells(glm::ivec3 cells, int level) {
    const int round_up = (1 << level) - 1;
    return {(cells.x + round_up) >> level, (cells.y + round_up) >> level, (cells.z + round_up) >> level};
  }

  /// Levels down to one cell, one beside the other; slabs one behind the other.
  void scratch_levels(Ports& ports, const char* name, const TextureDesc& coverage, Format format, int slabs) {
    const glm::ivec3 cells(coverage.width, coverage.height, coverage.depth);
    levels_ = 1;
    int width = cells.x;
    while (std::max({level_cells(cells, levels_ - 1).x, level_cells(cells, levels_ - 1).y,
                     level_cells(cells, levels_ - 1).z}) > 1) {
      width += level_cells(cells, levels_).x;
      ++levels_;
    }
    TextureDesc desc = coverage;
    desc.format = format;
    desc.filter = Filter::linear;
    desc.width = width;
    desc.depth *= slabs;
    slabs_ = slabs;
    ports.scratch(name, desc, Access::image_read_write);
  }

  void build_levels(Frame& frame, const Bindings& bindings) const {
    const glm::ivec3 cells(bindings.data<interop::Grid>("voxels").cells);
    // The pyramid of directions is filtered, and so written whole.
    const int width = slabs_ > 1 ? bindings.texture("scratch.pyramid").desc().width : cells.x;
    frame.dispatch(*base_, bindings, {width, cells.y, slabs_ * cells.z});
    frame.barrier();
    for (int level = 1; level < levels_; ++level) {
      const glm::ivec3 coarse = level_cells(cells, level);
      reduce_->set("level", level);
      frame.dispatch(*reduce_, bindings, {coarse.x, coarse.y, slabs_ * coarse.z});
      frame.barrier();
    }
    if (draw_) {
      draw_->set("levels", levels_);
      frame.dispatch(*draw_, bindings, {static_cast<int>(targets), 1, 1});
      frame.barrier();
    } else {
      resolution_.each_program([&](const Program& program) { program.set("levels", levels_); });
    }
  }

  std::string method_ = "rays", storage_ = "fp32";
  int rays_ = 64, aimed_ = 0, cones_ = 32, probes_ = 8, channels_ = 3;
  int levels_ = 1, slabs_ = 1;  // of the pyramid
  int rounds_of_ray_ = 1;
  bool emitter_ = false, emission_ = false, sky_image_ = false, has_light_ = false, pixels_ = false, sleeps_ = false;
  std::optional<std::uint64_t> marched_;  ///< what the rays of cells that are awake depend on
  interop::Grid probe_grid_{};
  Resolution resolution_;
  std::shared_ptr<const Program> base_, reduce_, draw_, wake_, volume_;
};

}  // namespace

LOOM_PLUGIN("ray_march", registry) {
  registry.add<RayMarch>("RayMarch", "Irradiance by rays or cones through the voxelized scene");
}
