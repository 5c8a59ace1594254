// InstantRadiosity: virtual point lights by light tracing (Keller, "Instant Radiosity", SIGGRAPH 1997).
//
// `paths` light paths leave lights, emissive triangles and sky, in proportion to the power of each, on low-discrepancy
// points; path i of a source with power share p begins with the flux
//   point and spot   Φ = I(ω)·Ω/(N·p)            Ω = 4π, or 2π(1−cos) of the cone, sr
//   directional      Φ = E⊥·A/(N·p)              A: rectangle across the light that covers the scene's box, m²
//   emissive         Φ = π·L·A_triangle/(N·p·p_triangle)
//   sky              Φ = L(ω)·4π·A(ω)/(N·p)
// and leaves a light Φ' = ρ·Φ at each surface that it meets: what the surface reflects. It goes on with Φ', by density
// cosθ/π. `roulette`: it survives with probability max ρ and Φ'/max ρ, so that most lights have about the same flux;
// without, every path goes on for `bounces` reflections. Light straight from a source is no virtual light: that is
// DirectLight's and AreaLight's to count, and GatherVpls brings what has been reflected at least once.
//
// Paths are traced against the scene's BVH on the GPU, and take their numbers from their index alone. So in a scene
// that moves, lights where nothing changed are the same to the bit, and with `update` = `keep` a light of first order
// stays where it is as long as its source still sees it through the path's own stratum of directions (after Laine et
// al., "Incremental Instant Radiosity for Real-Time Indirect Illumination", EGSR 2007); what no longer holds is
// replaced. One path a stratum keeps the estimate within a stratum's size of the traced one. `counts` tells how many
// lights were kept.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/light.h"
#include "interop/vpl.h"
#include "loom/fingerprint.h"
#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

constexpr double pi = std::numbers::pi;
// Sources in scratch_starts that are no punctual light.
constexpr int emitters = -1, sky = -2;

double mean(const glm::vec3& v) { return (static_cast<double>(v.x) + v.y + v.z) / 3; }

class InstantRadiosity final : public Pass {
 public:
  void params(Params& p) override {
    constexpr auto graph = Cost::graph;
    p.integer("paths", paths_, {.min = 1, .max = 65536, .scale = Scale::log, .cost = graph, .doc = "light paths"});
    p.integer("bounces", bounces_,
              {.min = 1, .max = 16, .cost = graph, .doc = "reflections of a path, at each of which it leaves a light"});
    p.choice("roulette", roulette_, {"albedo", "none"},
             {.cost = Cost::shader, .doc = "a path ends by chance where surfaces are dark, or goes on with less flux"});
    p.choice("renew", renew_, {"never", "sample", "frame"},
             {.cost = graph,
              .doc = "when other paths are taken: never, for each sub-pixel sample, or for each frame, too, for a "
                     "pipeline that accumulates"});
    p.choice("update", update_, {"trace", "keep"},
             {.cost = graph, .doc = "whether lights stay where they are while their source still sees them"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto vpls = ports.out("vpls", "VplSet");
    auto counts = ports.out("counts", "Image");
    const bool dark = facts.lights() == 0 && facts.emissive_triangles == 0 && !facts.sky;
    if (dark || facts.triangles == 0) {
      const std::string why = dark ? "nothing shines: no light, no emitter, black sky" : "the scene has no triangle";
      vpls.absent(why);
      return counts.absent(why);
    }
    facts_ = facts;
    orders_ = std::min(bounces_, rules::bounces(ports, facts.max_albedo));
    rules::decide_bounces(ports, facts.max_albedo, bounces_);
    const std::size_t slots = static_cast<std::size_t>(paths_) * static_cast<std::size_t>(orders_);
    vpls.buffer("lights", BufferDesc{sizeof(interop::VplHeader) + slots * sizeof(interop::Vpl)}).needed("lights");
    vpls.attribute("most", static_cast<int>(slots)).attribute("orders", orders_);
    vpls.attribute("channels", rules::channels(ports, facts));
    counts.texture("image", TextureDesc::image({1, 1}, Format::rgba32f), Access::image_write);
    counts.attribute("quantity", "lights, kept, paths, W");
    ports.persistent("slots", BufferDesc{slots * sizeof(interop::Vpl)});
    ports.scratch("starts", BufferDesc{static_cast<std::size_t>(paths_) * sizeof(glm::ivec4)});
    if (renew_ != "frame") ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    auto defines = scene_defines(facts_);
    defines.emplace_back("ROULETTE", roulette_ == "albedo" ? "1" : "0");
    defines.emplace_back("KEEP", update_ == "keep" ? "1" : "0");
    defines.emplace_back("PUNCTUAL", facts_.lights() > 0 ? "1" : "0");
    defines.emplace_back("EMITTERS", facts_.emissive_triangles > 0 ? "1" : "0");
    trace_ = device.program({.files = {"instant_radiosity/trace.comp"}, .defines = std::move(defines)});
    collect_ = device.program({.files = {"instant_radiosity/collect.comp"},
                               .defines = {{"COUNTS", bindings.has("counts.image") ? "1" : "0"}}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    const std::vector<glm::ivec4> starts = assign(frame.scene());
    bindings.buffer("scratch.starts").write(std::as_bytes(std::span(starts)));
    bindings.publish("vpls", interop::VplSet{.count = {paths_, orders_, 0, 0}});
    trace_->set("order_count", orders_);
    trace_->set("sequence", sequence(frame));
    trace_->set("box_low", glm::vec3(facts_.bounds_min));
    trace_->set("box_high", glm::vec3(facts_.bounds_max));
    frame.dispatch(*trace_, bindings, {paths_, 1, 1});
    frame.barrier();
    collect_->set("order_count", orders_);
    frame.dispatch(*collect_, bindings, {1, 1, 1});
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return mix_in(scene_version(frame.scene(), frame.info().seed), sequence(frame));
  }

 private:
  /// Which set of paths the frame takes.
  [[nodiscard]] std::uint32_t sequence(const Frame& frame) const {
    const FrameInfo& info = frame.info();
    std::uint64_t hash = info.seed;
    if (renew_ != "never") hash = mix_in(hash, info.sample);
    if (renew_ == "frame") hash = mix_in(hash, info.index);
    return static_cast<std::uint32_t>(hash ^ hash >> 32U);
  }

  struct Source {
    int id = 0;
    double power = 0;  ///< W, roughly: any positive number leaves the sum unbiased
    int paths = 0;
  };

  [[nodiscard]] std::vector<Source> sources(const SceneView& scene) const {
    const glm::dvec3 size = facts_.bounds_max - facts_.bounds_min;
    const double box = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
    std::vector<Source> list;
    int index = 0;
    for (const interop::Light& light : scene.lights()) {
      const int kind = static_cast<int>(light.position.w);
      // A convex body shows a quarter of its surface on average.
      const double extent = kind == LIGHT_DIRECTIONAL ? box / 4
                            : kind == LIGHT_SPOT      ? 2 * pi * (1 - std::min(1.F, light.cone.x))
                                                      : 4 * pi;
      list.push_back({index++, mean(light.intensity) * extent});
    }
    if (facts_.emissive_triangles > 0) list.push_back({emitters, facts_.emitted_power});
    if (facts_.sky) list.push_back({sky, pi * mean(scene.sky_radiance()) * box});
    return list;
  }

  /// What each path begins at: source, index among that source's paths, their number, and the bits of 1/(N·p). Path i
  /// takes the source that holds the share of van der Corput's point i, so that any 2ᵏ paths in a row have the sources
  /// in proportion, and consecutive points of each: a small set of its own.
  [[nodiscard]] std::vector<glm::ivec4> assign(const SceneView& scene) const {
    std::vector<Source> list = sources(scene);
    double total = 0;
    for (const Source& source : list) total += std::isfinite(source.power) ? source.power : 0;
    std::vector<glm::ivec4> starts(static_cast<std::size_t>(paths_), glm::ivec4(0));
    if (!(total > 0)) return starts;  // weight 0
    std::vector<std::size_t> taken;
    std::uint32_t i = 0;
    for (glm::ivec4& start : starts) {
      double left = radical_inverse(i++) * total;
      std::size_t s = 0;
      while (s + 1 < list.size() && left >= list[s].power) left -= list[s++].power;
      start.x = list[s].id;
      start.y = list[s].paths++;
      start.w = std::bit_cast<std::int32_t>(static_cast<float>(total / (list[s].power * paths_)));
      taken.push_back(s);
    }
    for (std::size_t k = 0; k < starts.size(); ++k) starts[k].z = list[taken[k]].paths;
    return starts;
  }

  /// Van der Corput's point, in the middle of its interval of `paths_`.
  [[nodiscard]] double radical_inverse(std::uint32_t i) const {
    double value = .5 / paths_, digit = .5;
    for (; i != 0; i >>= 1U, digit /= 2) value += (i & 1U) != 0 ? digit : 0;
    return std::min(value, 1 - 1e-12);
  }

  int paths_ = 1024;
  int bounces_ = 6;
  std::string roulette_ = "albedo", renew_ = "sample", update_ = "trace";
  int orders_ = 1;
  SceneFacts facts_;
  std::shared_ptr<const Program> trace_, collect_;
};

}  // namespace

LOOM_PLUGIN("instant_radiosity", registry) {
  registry.add<InstantRadiosity>("InstantRadiosity", "Virtual point lights by light tracing over several bounces");
}
