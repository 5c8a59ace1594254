// Inject: what the lights see becomes flux in a grid, and what lights and camera see becomes blockers.
//
// Every texel of a reflective shadow map is a Lambertian emitter of flux Φ [W] about its normal n:
//   I(ω) += Φ/π·⟨n,ω⟩₊, as two-band SH (.886227, 1.023327·n)·Φ/π, in the cell half a cell off the surface.
// Every texel and every pixel is a surface element of area A that blocks the cell face nearest to it along each axis e:
//   B_e = min(1, Σ A·|⟨n,e⟩|/s²).
// Sums are fixed point, with a scale derived from each light's own power: order-independent, and 1 W beside 1e8 W keeps
// its digits, since each light is resolved to float before the next.
#include "loom/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "interop/grid.h"
#include "interop/light.h"

namespace {

using namespace loom;

constexpr double pi = std::numbers::pi;
const std::array<std::string, 3> channels{"red", "green", "blue"};

/// A cubic grid of n³ cells around the scene's box, with one empty cell on each side: no surface lies outside, and
/// the two outermost faces of a wall at the border exist.
interop::Grid fit_grid(const SceneFacts& facts, int n) {
  const glm::dvec3 extent = facts.bounds_max - facts.bounds_min;
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
  const double s = n > 2 ? longest / (n - 2) : longest;
  const glm::dvec3 lower = .5 * (facts.bounds_min + facts.bounds_max) - glm::dvec3(.5 * s * n);
  interop::Grid grid{};
  grid.cells = {n, n, n, 1};
  grid.cascade[0] = glm::vec4(glm::vec3(lower), static_cast<float>(s));
  return grid;
}

class Inject final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("grid", grid_,
              {.min = 1,
               .max = 128,
               .unit = "cells",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "cells along each side of the scene's box"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.in("lights", "LightLayers").reads("flux").reads("normal").reads("depth");
    lights.reads("faces", Access::storage_read);
    auto surface = ports.in("surface", "Surface").optional();
    surface.reads("depth").reads("geometric_normal").reads("albedo");
    auto flux = ports.out("flux", "ShVolume").attribute("bands", 2);
    auto blockers = ports.out("blockers", "VoxelScene");
    if (lights.absent()) {
      flux.absent(lights.why_absent());
      return blockers.absent(lights.why_absent());
    }
    grid_block_ = fit_grid(facts, grid_);
    for (const std::string& channel : channels) {
      flux.texture(channel, TextureDesc::volume(grid_, Format::rgba32f), Access::image_read_write).cleared(channel);
    }
    blockers
        .texture("occupancy", TextureDesc::volume(grid_, Format::rgba32f, Filter::nearest), Access::image_read_write)
        .cleared("occupancy");
    TextureDesc albedo = TextureDesc::volume(grid_, Format::rgba16f, Filter::nearest);
    albedo.depth *= 3;  // one slab a face axis
    blockers.texture("albedo", albedo, Access::image_write).cleared("albedo");

    const std::size_t cells = static_cast<std::size_t>(grid_) * grid_ * grid_;
    ports.scratch("fixed", BufferDesc{.bytes = 12 * cells * sizeof(std::int32_t)});
    ports.scratch("area", BufferDesc{.bytes = 12 * cells * sizeof(std::uint32_t)});
    ports.decide("bounds", std::to_string(grid_) + "³ cells of " + std::to_string(grid_block_.cascade[0].w) + " m",
                 "longest side of the scene's box");
  }

  void prepare(Device& device, const Bindings& bindings) override {
    blocks_ = bindings.has("blockers.occupancy");
    light_ = device.program({.files = {"inject/light.comp"}});
    camera_ = device.program({.files = {"inject/camera.comp"}});
    resolve_flux_.clear();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (!bindings.has("flux." + channels[i])) continue;
      resolve_flux_.push_back(
          device.program({.files = {"inject/resolve_flux.comp"},
                          .defines = {{"VOLUME", "flux_" + channels[i]}, {"CHANNEL", std::to_string(i)}}}));
    }
    resolve_blockers_ = nullptr;
    if (blocks_) {
      resolve_blockers_ = device.program({.files = {"inject/resolve_blockers.comp"},
                                          .defines = {{"ALBEDO", bindings.has("blockers.albedo") ? "1" : "0"}}});
    }
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    bindings.publish("flux", grid_block_);
    bindings.publish("blockers", grid_block_);
    bindings.buffer("scratch.fixed").clear();
    bindings.buffer("scratch.area").clear();
    const glm::ivec3 cells(grid_block_.cells);
    const int size = bindings.texture("lights.flux").desc().width;

    for (const interop::Light& light : frame.scene().lights()) {
      const int faces = static_cast<int>(light.intensity.w);
      const auto scale = static_cast<float>(flux_scale(light, frame.scene().facts()));
      if (scale <= 0) continue;
      const float area_scale = element_scale(static_cast<double>(size) * size * faces);
      light_->set("first_face", static_cast<int>(light.direction.w));
      light_->set("flux_scale", scale);
      light_->set("area_scale", area_scale);
      frame.dispatch(*light_, bindings, {size, size, faces});
      resolve(frame, bindings, cells, scale, area_scale);
    }
    if (blocks_ && !bindings.absent("surface")) {
      const float area_scale = element_scale(static_cast<double>(frame.size().x) * frame.size().y);
      camera_->set("area_scale", area_scale);
      frame.dispatch(*camera_, bindings, {frame.size(), 1});
      resolve(frame, bindings, cells, 0, area_scale);
    }
  }

 private:
  /// What one buffer left in the fixed-point sums goes to the volumes.
  void resolve(Frame& frame, const Bindings& bindings, glm::ivec3 cells, float flux_scale, float area_scale) {
    frame.barrier();
    if (flux_scale > 0) {
      for (const auto& resolve : resolve_flux_) {
        resolve->set("flux_scale", flux_scale);
        frame.dispatch(*resolve, bindings, cells);
      }
    }
    if (blocks_) {
      resolve_blockers_->set("area_scale", area_scale);
      frame.dispatch(*resolve_blockers_, bindings, cells);
    }
    frame.barrier();
  }

  /// Fixed-point units a W/sr. A light's reflected flux is at most its power, 4π·I (directional: E⊥ over the scene's
  /// bounding sphere's section), and one coefficient at most 1.0234/π of a flux: the sum stays below 2³⁰.
  static double flux_scale(const interop::Light& light, const SceneFacts& facts) {
    const double peak = std::max({light.intensity.r, light.intensity.g, light.intensity.b});
    const double diameter = glm::length(facts.bounds_max - facts.bounds_min);
    const bool directional = static_cast<int>(light.position.w) == LIGHT_DIRECTIONAL;
    const double power = peak * (directional ? diameter * diameter : 4 * pi);
    return power > 0 ? 0x1p30 / (power * 1.0234 / pi) : 0;
  }

  /// Fixed-point units a cell face: `elements` of them, each at most one face, cannot wrap 32 bits.
  static float element_scale(double elements) {
    return static_cast<float>(std::min(0x1p24, std::floor(4294967040. / std::max(1., elements)) - 1));
  }

  int grid_ = 32;
  interop::Grid grid_block_{};
  bool blocks_ = false;
  std::shared_ptr<const Program> light_, camera_, resolve_blockers_;
  std::vector<std::shared_ptr<const Program>> resolve_flux_;  // of the channels that are read
};

}  // namespace

LOOM_PLUGIN("inject", registry) {
  registry.add<Inject>("Inject", "Flux and blockers in a grid, from what lights and camera see");
}
