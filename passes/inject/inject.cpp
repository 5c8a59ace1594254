// Inject: what surfaces reflect becomes flux in a grid, and what lights, camera and other views see becomes blockers.
//
// Every texel of a reflective shadow map is a Lambertian emitter of flux Φ [W] about its normal n:
//   I(ω) += Φ/π·⟨n,ω⟩₊, as two-band SH (.886227, 1.023327·n)·Φ/π, in the cell half a cell off the surface.
// Light of emissive surfaces and of the sky is traced to where it first meets a surface (`emission_rays`), and what
// that reflects is injected in the same way. So the flux holds light after exactly one reflection; the way to that
// surface is DirectLight's and AreaLight's, and nothing is counted twice. Every texel and every pixel is a surface
// element of area A that blocks the cell face nearest to it along each axis e:
//   B_e = min(1, Σ A·|⟨n,e⟩|/s²).
// So is every point of a geometry image: the surface itself (`samples`), further views of it (`views`) and cubemaps
// (`environment`). Such points may bring the light that they reflect too, in place of the lights' maps.
// As the lecture has it, blockers go by direction of travel at the corners of cells: B(ω) = Σ A/s²·⟨n,−ω⟩₊ as SH.
//
// `compute` sums in fixed point, with a scale derived from each source's own power: order-independent, and 1 W beside
// 1e8 W keeps its digits, since each source is resolved to float before the next. `points` draws every element as a
// point into a layer of the volumes and lets blending add up in 32-bit float.
#include "loom/fingerprint.h"
#include "loom/grid.h"
#include "loom/plugin.h"
#include "loom/rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cascades.h"
#include "interop/grid.h"
#include "interop/light.h"

namespace {

using namespace loom;

constexpr double pi = std::numbers::pi;
const std::array<std::string, 3> channels{"red", "green", "blue"};
constexpr std::array<std::string_view, 3> flux_members{"flux.red", "flux.green", "flux.blue"};

// What OpenGL 4.5 guarantees for the side of a volume.
constexpr int max_slices = 2048;
// EmissionHit in shaders/inject/hit.glsl.
constexpr std::size_t hit_bytes = 48;
// ROW in shaders/inject/elements.glsl.
constexpr int row = 4096;
glm::ivec3 in_rows(int elements) { return {row, (elements + row - 1) / row, 1}; }

/// Inputs of type GeometryImage.
constexpr std::array<std::string_view, 3> point_inputs{"samples", "views", "environment"};

class Inject final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("grid", grid_,
              {.min = 1,
               .max = 128,
               .unit = "cells",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "cells along each side of a cascade; the coarsest spans the scene's box"});
    p.integer("cascades", cascades_,
              {.min = 1,
               .max = LOOM_MAX_CASCADES,
               .cost = Cost::graph,
               .doc = "nested grids ahead of the camera, each of half the cell of the next"});
    p.integer("emission_rays", emission_rays_,
              {.min = 0,
               .max = 1048576,
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "rays from all emissive triangles, and again from the sky, to what they light; 0 = none"});
    p.choice("method", method_, {"compute", "points"},
             {.cost = Cost::graph, .doc = "how flux is summed: fixed-point atomics, or points blended into layers"});
    p.choice(
        "storage", storage_, {"fp32", "fp16"},
        {.cost = Cost::graph,
         .doc = "of flux and blocked shares; `fp16`: half the memory, 11 bits, rounded once a light, and at most "
                "65504 W/sr a coefficient. Flux that `points` blend stays in fp32: in halves it would stop growing"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.in("lights", "LightLayers").optional().reads("flux").reads("normal").reads("depth");
    lights.reads("faces", Access::storage_read);
    auto surface = ports.in("surface", "Surface").optional();
    surface.reads("depth").reads("geometric_normal").reads("albedo");
    // Emission is the scene's; what comes over the wires says so itself.
    channels_ = std::max(rules::channels(ports, facts), rules::channels({lights, surface}));
    auto flux = ports.out("flux", "ShVolume").attribute("bands", 2).attribute("cascades", cascades_);
    auto blockers = ports.out("blockers", "VoxelScene").attribute("cascades", cascades_);
    emitters_ = facts.emissive_triangles > 0 && emission_rays_ > 0;
    sky_ = (facts.sky || !ports.rule("no-emission")) && emission_rays_ > 0;  // a black sky adds nothing
    lit_ = !lights.absent();
    const bool lit_points = declare_points(ports);
    flux.attribute("channels", channels_);
    blockers.attribute("channels", channels_);
    // What passes made of the scene says its channels; a program's own surfaces may have any albedo.
    const auto of_scene = [](const InputPort& input) { return input.absent() || input.attribute("channels", 0) > 0; };
    if (points_.empty() && of_scene(lights) && of_scene(surface)) blockers.attribute("max_albedo", facts.max_albedo);
    if (!lit_ && !lit_points && !emitters_ && !sky_) {
      const std::string why = lights.connected() ? lights.why_absent() : "no lights are wired";
      flux.absent(why + ", and no emission is traced");
      return blockers.absent(why + ", and no emission is traced");
    }
    if (3 * cascades_ * grid_ > max_slices) {
      ports.error("inject-cells",
                  std::to_string(cascades_) + " cascades of " + std::to_string(grid_) +
                      "³ cells: three axes of albedo exceed 2048 slices",
                  "cascades × grid must be at most " + std::to_string(max_slices / 3));
    }
    coarsest_ = fit_grid(rules::bounds(ports, facts), grid_, GridShape::cube);
    scene_centre_ = glm::vec3(.5 * (facts.bounds_min + facts.bounds_max));
    scene_radius_ = static_cast<float>(.5 * glm::length(facts.bounds_max - facts.bounds_min));
    scene_defines_ = scene_defines(facts);
    declare(ports, flux, blockers);
    retrace_ = facts.moves || !ports.rule("static");
    if (!facts.moves) ports.keep_outputs();
    ports.decide("bounds", std::to_string(grid_) + "³ cells of " + std::to_string(coarsest_.cascade[0].w) + " m",
                 rules::bounds_text(ports, facts));
    if (!emitters_ && !sky_) ports.decide("no-emission", "no emission is traced", "no emissive triangle, black sky");
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const auto flag = [](bool on) { return on ? "1" : "0"; };
    const auto has = [&](const std::string& member) { return flag(bindings.has(member)); };
    blocks_ = bindings.has("blockers.occupancy");
    const Define color{"CHANNELS", std::to_string(channels_)};
    const Define half{"HALF", flag(storage_ == "fp16")};
    const std::vector<Define> which_blockers = {
        color, half, {"ALBEDO", has("blockers.albedo")}, {"DIRECTIONAL", has("blockers.directional")}};
    const std::vector<Define> which_channels = {
        color, half, {"RED", has("flux.red")}, {"GREEN", has("flux.green")}, {"BLUE", has("flux.blue")}};
    const auto source = [&](const std::vector<Define>& from, bool blocks, bool shines = true) {
      auto defines = which_blockers;
      defines.insert(defines.end(), from.begin(), from.end());
      defines.emplace_back("FLUX", flag(shines && method_ == "compute"));
      Source programs{.compute = device.program({.files = {"inject/flux.comp"}, .defines = defines}),
                      .blocks = blocks && blocks_,
                      .shines = shines};
      if (shines && method_ == "points") {
        auto drawn = from;
        drawn.push_back(color);
        programs.points = device.program(
            {.files = {"inject/points.vert", "inject/points.geom", "inject/points.frag"}, .defines = drawn});
      }
      if (shines && method_ == "compute")
        programs.scale = device.program({.files = {"inject/scale.comp"}, .defines = from});
      return programs;
    };
    if (lit_) light_ = source({{"SOURCE", "FROM_LIGHT"}}, true);
    for (PointSource& points : points_) {
      std::vector<Define> from{{"SOURCE", "FROM_POINTS"}};
      for (const auto& [define, member] :
           {std::pair("IMAGE_POSITION", "_position"), std::pair("IMAGE_NORMAL", "_normal"),
            std::pair("IMAGE_ALBEDO", "_albedo"), std::pair("IMAGE_FLUX", "_flux")}) {
        if (points.lit || member != std::string_view("_flux")) from.emplace_back(define, points.input + member);
      }
      points.source = source(from, true, points.lit);
    }
    if (emitters_ || sky_) {
      hits_ = source({{"SOURCE", "FROM_EMISSION"}}, false);
      auto defines = scene_defines_;
      defines.emplace_back("EMITTERS", flag(emitters_));
      defines.emplace_back("SKY", flag(sky_));
      trace_ = device.program({.files = {"inject/emission.comp"}, .defines = defines});
      traced_.reset();
    }
    if (method_ == "compute") {
      resolve_flux_ = device.program({.files = {"inject/resolve_flux.comp"}, .defines = which_channels});
    }
    if (blocks_) {
      camera_ = device.program({.files = {"inject/camera.comp"}, .defines = which_blockers});
      resolve_blockers_ = device.program({.files = {"inject/resolve_blockers.comp"}, .defines = which_blockers});
    }
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const interop::Grid grid = inject::place_cascades(coarsest_, cascades_, frame.camera());
    bindings.publish("flux", grid);
    bindings.publish("blockers", grid);
    if (emitters_ || sky_) trace_emission(frame, bindings);
    for (int cascade = 0; cascade < cascades_; ++cascade) {
      if (lit_) inject_lights(frame, bindings, cascade);
      for (const PointSource& points : points_) inject_points(frame, bindings, points, cascade);
      if (emitters_ || sky_) inject_emission(frame, bindings, cascade);
      if (blocks_ && !bindings.absent("surface")) {
        clear_sums(bindings);
        camera_->set("cascade", cascade);
        frame.dispatch(*camera_, bindings, {frame.size(), 1});
        frame.barrier();
        resolve_blockers(frame, bindings, cascade);
      }
    }
  }

  /// What comes over the wires, the camera's surface too, is the executor's to watch.
  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return mix_in(scene_version(frame.scene(), frame.info().seed),
                  inject::place_cascades(coarsest_, cascades_, frame.camera()));
  }

 private:
  struct Source {
    /// `points` is null where atomics sum the flux, `scale` where they do not.
    std::shared_ptr<const Program> compute, points, scale;
    bool blocks = false, shines = false;
  };
  /// A geometry image.
  struct PointSource {
    std::string input;
    int buffers = 1;   ///< groups of layers that may see one surface again
    bool lit = false;  ///< it brings flux
    Source source;
  };

  /// True where any of them brings light.
  bool declare_points(Ports& ports) {
    points_.clear();
    int lit = 0;
    for (const std::string_view name : point_inputs) {
      auto input = ports.in(name, "GeometryImage").optional();
      input.reads("position").reads("normal").reads("albedo").reads("flux");
      if (input.absent() || input.texture("position") == nullptr) continue;
      points_.push_back({.input = std::string(name),
                         .buffers = std::max(1, input.attribute("buffers", 1)),
                         .lit = input.texture("flux") != nullptr});
      lit += points_.back().lit ? 1 : 0;
      channels_ = std::max(channels_, rules::channels({input}));
    }
    if (lit + (lit_ ? 1 : 0) > 1) {
      ports.error("counted-twice",
                  "more than one input brings the light that surfaces reflect straight from the lights",
                  "wire `lights` to Inject, or to one of the passes that make its points");
    }
    return lit > 0;
  }

  void declare(Ports& ports, OutputPort& flux, OutputPort& blockers) const {
    const auto volume = [&](Format format, Filter filter, int slabs) {
      TextureDesc desc = TextureDesc::volume(grid_, format, filter);
      desc.depth *= slabs;
      return desc;
    };
    const bool drawn = method_ == "points";
    const Access written = drawn ? Access::color : Access::image_read_write;
    const Format stored = storage_ == "fp16" ? Format::rgba16f : Format::rgba32f;
    for (int i = 0; i < channels_; ++i) {
      const std::string& channel = channels[static_cast<std::size_t>(i)];
      flux.texture(channel, volume(drawn ? Format::rgba32f : stored, Filter::linear, cascades_), written)
          .cleared(channel);
    }
    const auto blocker = [&](const char* member, const TextureDesc& desc, Access access) {
      blockers.texture(member, desc, access).cleared(member);
    };
    blocker("occupancy", volume(stored, Filter::nearest, cascades_), Access::image_read_write);
    // One slab a face axis.
    blocker("albedo", volume(Format::rgba16f, Filter::nearest, 3 * cascades_).with_channels(channels_),
            Access::image_write);
    blocker("directional", volume(stored, Filter::nearest, cascades_), Access::image_read_write);
    // Which of two walls is the larger decides about the rest.
    for (const char* rest : {"albedo", "directional"}) blockers.needed("occupancy", rest);

    const std::size_t cells = static_cast<std::size_t>(grid_) * grid_ * grid_;
    if (method_ == "compute") {
      ports.scratch("fixed",
                    BufferDesc{.bytes = 4 * static_cast<std::size_t>(channels_) * cells * sizeof(std::int32_t)});
      ports.scratch("scale", BufferDesc{.bytes = 16});
    }
    // SLOTS of shaders/inject/inject.glsl, 16 of three channels: at 128³ cells the 128 MiB that OpenGL 4.5 guarantees a
    // block.
    const std::size_t slots = 3 * (1 + static_cast<std::size_t>(channels_)) + 4;
    for (const char* words : {"low", "high"}) ports.scratch(words, BufferDesc{slots * cells * sizeof(std::uint32_t)});
    if (emitters_ || sky_) ports.persistent("emission", BufferDesc{.bytes = hits() * hit_bytes});
  }

  /// Rays of both kinds.
  [[nodiscard]] std::size_t hits() const {
    return static_cast<std::size_t>(emission_rays_) * ((emitters_ ? 1 : 0) + (sky_ ? 1 : 0));
  }

  /// Where nothing has changed since, the rays of an earlier frame stand.
  void trace_emission(Frame& frame, const Bindings& bindings) {
    const std::uint64_t now = scene_version(frame.scene(), frame.info().seed);
    const bool after_reset = frame.info().index == 0 && frame.info().sample == 0;
    if (!retrace_ && !after_reset && traced_ == now) return;
    trace_->set("scene_centre", scene_centre_);
    trace_->set("scene_radius", scene_radius_);
    frame.dispatch(*trace_, bindings, in_rows(static_cast<int>(hits())));
    frame.barrier();
    traced_ = now;
  }

  void inject_lights(Frame& frame, const Bindings& bindings, int cascade) const {
    const int size = bindings.texture("lights.flux").desc().width;
    for (const interop::Light& light : frame.scene().lights()) {
      const auto scale = static_cast<float>(flux_scale(light, frame.scene().facts()));
      if (scale <= 0) continue;
      if (method_ == "compute") bindings.buffer("scratch.scale").write(std::as_bytes(std::span(&scale, 1)));
      const int elements = size * size * static_cast<int>(light.intensity.w);
      for (const auto& program : {light_.compute, light_.points}) {
        if (program) program->set("first_face", static_cast<int>(light.direction.w));
      }
      add(frame, bindings, light_, cascade, elements);
    }
  }

  void inject_emission(Frame& frame, const Bindings& bindings, int cascade) const {
    measure_scale(frame, bindings, hits_, static_cast<int>(hits()));
    add(frame, bindings, hits_, cascade, static_cast<int>(hits()));
  }

  void inject_points(Frame& frame, const Bindings& bindings, const PointSource& points, int cascade) const {
    const TextureDesc& desc = bindings.texture(points.input + ".position").desc();
    const int layers = desc.depth / points.buffers, elements = layers * desc.width * desc.height;
    for (int buffer = 0; buffer < points.buffers; ++buffer) {
      for (const auto& program : {points.source.compute, points.source.points, points.source.scale}) {
        if (program) program->set("first_layer", buffer * layers);
      }
      measure_scale(frame, bindings, points.source, elements);
      add(frame, bindings, points.source, cascade, elements);
    }
  }

  static void measure_scale(Frame& frame, const Bindings& bindings, const Source& source, int elements) {
    if (!source.scale) return;
    source.scale->set("elements", elements);
    frame.dispatch(*source.scale, bindings, {1, 1, 1});
    frame.barrier();
  }

  static void clear_sums(const Bindings& bindings) {
    for (const char* sums : {"scratch.fixed", "scratch.low", "scratch.high"}) {
      if (bindings.has(sums)) bindings.buffer(sums).clear();
    }
  }

  /// All elements of one source, to the volumes of one cascade.
  void add(Frame& frame, const Bindings& bindings, const Source& source, int cascade, int elements) const {
    clear_sums(bindings);
    source.compute->set("cascade", cascade);
    source.compute->set("elements", elements);
    if (source.blocks || (source.shines && !source.points)) {
      frame.dispatch(*source.compute, bindings, in_rows(elements));
      frame.barrier();
    }
    if (source.points) {
      source.points->set("cascade", cascade);
      source.points->set("elements", elements);
      frame.continue_raster(bindings, std::span(flux_members).first(static_cast<std::size_t>(channels_)));
      for (int i = 0; i < channels_; ++i) frame.blend(i, Blend::add);
      frame.points(*source.points, bindings, elements);
    } else if (source.shines) {
      resolve_flux_->set("cascade", cascade);
      frame.dispatch(*resolve_flux_, bindings, glm::ivec3(coarsest_.cells));
    }
    if (source.blocks) resolve_blockers(frame, bindings, cascade);
    frame.barrier();
  }

  /// What one buffer left in the sums of areas goes to the volumes.
  void resolve_blockers(Frame& frame, const Bindings& bindings, int cascade) const {
    resolve_blockers_->set("cascade", cascade);
    frame.dispatch(*resolve_blockers_, bindings, glm::ivec3(coarsest_.cells));
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

  int grid_ = 32, cascades_ = 1, emission_rays_ = 65536, channels_ = 3;
  std::string method_ = "compute", storage_ = "fp32";
  interop::Grid coarsest_{};
  glm::vec3 scene_centre_{0};
  float scene_radius_ = 0;
  std::vector<Define> scene_defines_;
  bool lit_ = false, emitters_ = false, sky_ = false, blocks_ = false;
  bool retrace_ = false;                 // every frame
  std::optional<std::uint64_t> traced_;  // the state of the scene that persistent.emission holds
  Source light_, hits_;
  std::vector<PointSource> points_;
  std::shared_ptr<const Program> camera_, trace_, resolve_flux_, resolve_blockers_;
};

}  // namespace

LOOM_PLUGIN("inject", registry) {
  registry.add<Inject>("Inject", "Flux and blockers in a grid, from what lights, emitters, sky and camera reach");
}
