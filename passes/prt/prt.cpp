// PRT: precomputed radiance transfer on a lattice (Sloan, Kautz and Snyder, "Precomputed Radiance Transfer for
// Real-Time Rendering in Dynamic, Low-Frequency Lighting Environments", SIGGRAPH 2002; unoriented, so that receivers
// need not be known).
//
// The environment (sky and directional lights) is L(ω) = Σ_j L_j Y_j(ω). A point x of the lattice holds the matrix that
// makes of it what arrives at x, by paths that leave x in all directions and are reflected until they leave the scene:
//   M_ij = ∫ Y_i(ω)·Y_j(ω')·Π ρ dω ≈ 4π/N·Σ Y_i(ω_k)·Y_j(ω'_k)·Π ρ,
// apart for straight light (ω' = ω, visibility alone) and for light that was reflected at least once. In each frame
//   L'_i = Σ_j M_ij·L_j   (`sky` from the straight part, `bounce` from the reflected one),
// which GatherProbes turns into irradiance as it does with any ProbeField. Turning the environment, and any change of
// its light, costs this product and no new path.
//
// VisibilityField keeps the straight part alone: `openness` holds V(ω), the visibility of the sky, as harmonics (V_i =
// M_i0·√4π), and `sky` what of the sky arrives.
//
// Transfer depends on the geometry alone: it is made once, where nothing moves, and kept in the user's cache by the
// scene's content hash and everything that it was made with.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/light.h"
#include "interop/probes.h"
#include "lattice.h"
#include "loom/cache.h"
#include "loom/fingerprint.h"
#include "loom/harmonics.h"
#include "loom/plugin.h"
#include "loom/rules.h"

namespace {

using namespace loom;

constexpr double pi = std::numbers::pi;
/// Raised whenever what is kept changes its meaning.
constexpr int cache_version = 1;
/// Bytes of the paths of a batch of points, and what OpenGL 4.5 guarantees of a storage block.
constexpr std::size_t batch_bytes = std::size_t{1} << 22, max_block_bytes = std::size_t{1} << 27;
constexpr std::size_t path_bytes = 2 * sizeof(glm::vec4);

class Transfer : public Pass {
 public:
  explicit Transfer(bool reflects) : reflects_(reflects) {}

  void params(Params& p) override {
    constexpr auto graph = Cost::graph;
    p.integer("points", points_,
              {.min = 2,
               .max = 64,
               .scale = Scale::log,
               .cost = graph,
               .doc = "points of the lattice along the longest side of the scene's box; as dense along the others"});
    p.integer("order", order_,
              {.min = 0, .max = 3, .cost = graph, .doc = "highest band of harmonics; (order+1)² coefficients"});
    p.integer("paths", paths_,
              {.min = 16, .max = 2048, .scale = Scale::log, .cost = graph, .doc = "paths from each point, once"});
    p.integer("moments", moments_,
              {.min = 1,
               .max = 32,
               .unit = "texels",
               .scale = Scale::log,
               .cost = graph,
               .doc = "side of the octahedral map of distances by which a point's visibility is judged"});
    p.real("inset", inset_,
           {.min = 0,
            .max = .5,
            .unit = "grid steps",
            .cost = graph,
            .doc = "distance of the outermost points from the sides of the scene's box"});
    p.real(
        "inside", inside_,
        {.min = 0,
         .max = 1,
         .unit = "of the sphere",
         .cost = graph,
         .doc = "a point that sees more than this share as backs of single-sided faces is inside of something: off"});
    p.boolean("cache", cache_, {.doc = "keep the transfer in the user's cache folder, and take it from there"});
    if (!reflects_) return;
    p.integer("bounces", bounces_, {.min = 1, .max = 16, .cost = graph, .doc = "most reflections of a path"});
    p.boolean(
        "distant", distant_,
        {.cost = graph,
         .doc = "count the straight light of directional lights in `sky`, too: for pipelines without DirectLight"});
    p.real("rotation", rotation_,
           {.min = -360, .max = 360, .unit = "degrees", .doc = "turns the environment about the upward axis"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    const auto second_name = reflects_ ? "bounce" : "openness";
    auto straight = ports.out("sky", "ProbeField");
    auto second = ports.out(second_name, "ProbeField");
    const bool lit = facts.sky || (reflects_ && facts.directional_lights > 0);
    const std::string why = facts.geometry_moves   ? "geometry moves: transfer cannot be precomputed"
                            : facts.triangles == 0 ? "the scene has no triangle"
                            : lit || !reflects_    ? ""
                                                   : "black sky, no directional light";
    const bool straight_lit = facts.sky || (reflects_ && distant_ && facts.directional_lights > 0);
    if (!why.empty()) {
      straight.absent(why);
      return second.absent(why);
    }
    facts_ = facts;
    coefficients_ = (order_ + 1) * (order_ + 1);
    orders_ = 0;
    if (reflects_) {
      orders_ = std::min(bounces_, rules::bounces(ports, facts.max_albedo));
      rules::decide_bounces(ports, facts.max_albedo, bounces_);
    }
    grid_ = prt::fit_lattice(rules::bounds(ports, facts),
                             {.points = points_, .inset = inset_, .coefficients = coefficients_, .moments = moments_});
    const std::size_t bytes = static_cast<std::size_t>(point_count()) * stride() * sizeof(glm::vec4);
    if (bytes > max_block_bytes) {
      return ports.error("too-many-points",
                         std::to_string(point_count()) + " points of " + std::to_string(coefficients_) +
                             " coefficients: the transfer would be larger than the 128 MiB that every device can bind",
                         "fewer points, a lower order, or a smaller map of distances");
    }
    const int channels = rules::channels(ports, facts);
    const auto declare = [&](OutputPort& out) {
      const glm::ivec3 n(grid_.counts);
      out.texture("coefficients",
                  TextureDesc::layers({n.x * coefficients_, n.y}, n.z, Format::rgba32f).with_channels(channels),
                  Access::image_write);
      out.texture("moments", TextureDesc::layers({n.x * moments_, n.y * moments_}, n.z, Format::rg32f),
                  Access::image_write);
      out.texture("state",
                  {.format = Format::rgba32f, .kind = TextureKind::d3, .width = n.x, .height = n.y, .depth = n.z},
                  Access::image_write);
      out.attribute("coefficients", coefficients_).attribute("basis", "sh").attribute("channels", channels);
    };
    straight_lit ? declare(straight) : straight.absent("black sky");
    declare(second);
    ports.scratch("baked", BufferDesc{bytes});
    ports.scratch("environment", BufferDesc{2 * static_cast<std::size_t>(coefficients_) * sizeof(glm::vec4)});
    ports.scratch("paths",
                  BufferDesc{static_cast<std::size_t>(batch()) * static_cast<std::size_t>(paths_) * path_bytes});
    ports.keep_outputs();
  }

  void prepare(Device& device, const Bindings& bindings) override {
    auto defines = scene_defines(facts_);
    const Define count{"COEFFICIENTS", std::to_string(coefficients_)};
    defines.push_back(count);
    trace_ = device.program({.files = {"prt/trace.comp"}, .defines = std::move(defines)});
    project_ = device.program({.files = {"prt/project.comp"}, .defines = {count}});
    const auto apply = [&](const std::string& port, const char* part) -> std::shared_ptr<const Program> {
      const auto has = [&](const char* member) { return bindings.has(port + "." + member); };
      if (!has("coefficients") && !has("moments") && !has("state")) return nullptr;
      return device.program({.files = {"prt/apply.comp"},
                             .defines = {count,
                                         {"PART", part},
                                         {"COEFFICIENTS_IMAGE", port + "_coefficients"},
                                         {"MOMENTS_IMAGE", port + "_moments"},
                                         {"STATE_IMAGE", port + "_state"},
                                         {"COEFFICIENTS_OUT", has("coefficients") ? "1" : "0"},
                                         {"MOMENTS_OUT", has("moments") ? "1" : "0"},
                                         {"STATE_OUT", has("state") ? "1" : "0"}}});
    };
    apply_straight_ = apply("sky", "aaa");
    apply_second_ = reflects_ ? apply("bounce", "rgb") : apply("openness", "aaa");
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    make_transfer(frame, bindings);
    const std::vector<glm::vec4> environment = environments(frame.scene());
    bindings.buffer("scratch.environment").write(std::as_bytes(std::span(environment)));
    const auto apply = [&](const std::shared_ptr<const Program>& program, const char* port, int first) {
      if (!program) return;
      bindings.publish(port, grid_);
      program->set("first_coefficient", first);
      dispatch(frame, bindings, *program, {point_count(), 1, 1});
    };
    apply(apply_straight_, "sky", 0);
    apply(apply_second_, reflects_ ? "bounce" : "openness", coefficients_);
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override { return scene_version(frame.scene()); }

 private:
  [[nodiscard]] int point_count() const { return grid_.counts.x * grid_.counts.y * grid_.counts.z; }
  /// vec4s of a point (shaders/prt/lattice.glsl).
  [[nodiscard]] std::size_t stride() const {
    const auto coefficients = static_cast<std::size_t>(coefficients_), moments = static_cast<std::size_t>(moments_);
    return coefficients * coefficients + moments * moments + 1;
  }
  [[nodiscard]] int batch() const {
    const auto points = static_cast<int>(batch_bytes / (static_cast<std::size_t>(paths_) * path_bytes));
    return std::clamp(points, 1, point_count());
  }

  void dispatch(Frame& frame, const Bindings& bindings, const Program& program, glm::ivec3 threads) const {
    program.set("grid_lower", glm::vec3(grid_.lower));
    program.set("grid_spacing", glm::vec3(grid_.spacing));
    program.set("grid_reach", grid_.spacing.w);
    program.set("counts_x", grid_.counts.x);
    program.set("counts_y", grid_.counts.y);
    program.set("counts_z", grid_.counts.z);
    frame.dispatch(program, bindings, threads);
  }

  /// What the transfer depends on, apart from its length.
  [[nodiscard]] std::uint64_t key(const SceneView& scene) const {
    std::uint64_t hash = mix_in(facts_.content_hash, scene.geometry_version());
    for (const int value : {cache_version, coefficients_, paths_, moments_, orders_}) hash = mix_in(hash, value);
    hash = mix_in(hash, inside_);
    return mix_in(mix_in(mix_in(hash, grid_.counts), grid_.lower), grid_.spacing);
  }

  /// Into scratch.baked: from memory, from the user's cache, or by tracing.
  void make_transfer(Frame& frame, const Bindings& bindings) {
    const std::uint64_t wanted = key(frame.scene());
    const Buffer& baked = bindings.buffer("scratch.baked");
    const std::size_t bytes = static_cast<std::size_t>(point_count()) * stride() * sizeof(glm::vec4);
    if (kept_.size() != bytes || kept_key_ != wanted) {
      std::array<char, 40> name{};
      std::snprintf(name.data(), name.size(), "transfer-%016llx.bin", static_cast<unsigned long long>(wanted));
      const bool named = cache_ && facts_.content_hash != 0;
      std::optional<std::vector<std::byte>> found;
      if (named) found = read_cached(name.data(), bytes);
      kept_key_ = wanted;
      if (!found) {
        trace(frame, bindings);
        kept_.resize(bytes);
        baked.read(kept_);
        if (named) write_cached(name.data(), kept_);
        return;
      }
      kept_ = std::move(*found);
    }
    baked.write(kept_);
  }

  void trace(Frame& frame, const Bindings& bindings) const {
    for (int first = 0; first < point_count(); first += batch()) {
      for (const Program* program : {trace_.get(), project_.get()}) {
        program->set("first_point", first);
        program->set("batch_size", batch());
      }
      trace_->set("reflections", orders_);
      dispatch(frame, bindings, *trace_, {paths_, batch(), 1});
      frame.barrier();
      dispatch(frame, bindings, *project_, {coefficients_ + moments_ * moments_, batch(), 1});
      frame.barrier();
    }
  }

  /// Of the scene's sky, projected once: turning it is turning these.
  const std::vector<glm::dvec3>& sky_harmonics(const SceneView& scene) {
    if (sky_.size() != static_cast<std::size_t>(coefficients_) || sky_version_ != scene.lights_version()) {
      sky_ = scene.sky_harmonics(order_);
      sky_version_ = scene.lights_version();
    }
    return sky_;
  }

  /// Harmonics of what the two outputs take of the environment, one behind the other.
  [[nodiscard]] std::vector<glm::vec4> environments(const SceneView& scene) {
    const auto n = static_cast<std::size_t>(coefficients_);
    std::vector<glm::vec4> both(2 * n, glm::vec4(0));
    const double angle = rotation_ * pi / 180;
    const std::vector<glm::dvec3> sky = turned_about_y(sky_harmonics(scene), angle);
    for (std::size_t i = 0; i < n; ++i) both[i] = glm::vec4(glm::vec3(sky[i]), 0);
    if (!reflects_) {
      both[n] = glm::vec4(static_cast<float>(std::sqrt(4 * pi)));
      return both;
    }
    std::copy_n(both.begin(), n, both.begin() + static_cast<std::ptrdiff_t>(n));
    for (const interop::Light& light : scene.lights()) {
      if (static_cast<int>(light.position.w) != LIGHT_DIRECTIONAL) continue;
      const auto y = harmonics(turned_about_y(-glm::dvec3(light.direction), angle), order_);
      for (std::size_t i = 0; i < n; ++i) {
        const glm::vec4 part(static_cast<float>(y[i]) * glm::vec3(light.intensity), 0);
        if (distant_) both[i] += part;
        both[n + i] += part;
      }
    }
    return both;
  }

  bool reflects_;
  int points_ = 8, order_ = 2, paths_ = 1024, moments_ = 8, bounces_ = 6;
  float inset_ = .1f, inside_ = .05f, rotation_ = 0;
  bool cache_ = true, distant_ = false;
  int coefficients_ = 9, orders_ = 0;
  interop::ProbeGrid grid_{};
  SceneFacts facts_;
  std::vector<std::byte> kept_;  ///< the transfer of kept_key_: a function of the scene, not a state
  std::uint64_t kept_key_ = 0;
  std::vector<glm::dvec3> sky_;  ///< harmonics at sky_version_, a function of the scene too
  std::uint64_t sky_version_ = 0;
  std::shared_ptr<const Program> trace_, project_, apply_straight_, apply_second_;
};

class PRT final : public Transfer {
 public:
  PRT() : Transfer(true) {}
};

class VisibilityField final : public Transfer {
 public:
  VisibilityField() : Transfer(false) {}
};

}  // namespace

LOOM_PLUGIN("prt", registry) {
  registry.add<PRT>("PRT", "Sky and distant light by transfer that is precomputed on a lattice");
  registry.add<VisibilityField>("VisibilityField", "How open each point of a lattice is to the sky, by direction");
}
