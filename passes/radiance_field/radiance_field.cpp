// RadianceField: a grid of probes that hold, as real spherical harmonics, the light that has been reflected at least
// once (Greger et al. 1998; Ramamoorthi and Hanrahan 2001; visibility as Majercik et al. 2019).
//
// Each probe captures what stands around it on six small cube faces: distance, normals, albedo ρ. Every texel reflects
//   L_1 = ρ/π·(E_punctual + E_emitters + E_sky),      with shadows by the lights' maps and by rays,
//   L_k = ρ/π·E_{k−1},                                E of the probes themselves, one order before,
// and a probe holds L_lm = Σ_t Y_lm(ω_t)·Δω_t·Σ_k L_k(ω_t), with Δω_t the exact solid angle of the texel,
// or the amplitudes of twelve spherical Gaussians that fit the same texels. What a surface emits itself, and the sky,
// are in no texel: they reach a receiver without a bounce, which is the part `emitter` of indirect light, so that
// nothing is counted twice. Orders are kept apart and each is made of the one before; nothing is fed back into itself,
// so that `bounces` means what it means for the path tracer.
//
// With `voxels` wired, texels look up what the voxelized scene reflects (all orders of `light`, where Radiosity is
// wired there) instead: L = R, once.
//
// Where `readers` is wired, and probes do not light each other, those that no pixel of it reads sleep: they are off
// until one does.
//
// With a `budget`, so many probes are captured and all their orders renewed in each frame, in turn; after `bounces`
// rounds the field of a still scene is exactly the field that is made at once.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/probes.h"
#include "loom/fingerprint.h"
#include "loom/plugin.h"
#include "loom/rules.h"
#include "probe_grid.h"
#include "sleepers.h"
#include "texel_weights.h"

namespace {

using namespace loom;

// What OpenGL 4.5 guarantees: MAX_ARRAY_TEXTURE_LAYERS and MAX_SHADER_STORAGE_BLOCK_SIZE.
constexpr int max_layers = 2048;
constexpr std::size_t max_block_bytes = std::size_t{1} << 27;
// As AreaLight: more emissive triangles are sampled.
constexpr int most_integrated_emitters = 8;

class RadianceField final : public Pass {
 public:
  void params(Params& p) override {
    constexpr auto graph = Cost::graph;
    p.integer("probes", probes_,
              {.min = 2,
               .max = 64,
               .scale = Scale::log,
               .cost = graph,
               .doc = "probes along the longest side of the scene's box; as dense along the others"});
    p.choice("capture", capture_by_, {"raster", "rays"},
             {.cost = graph,
              .doc = "how a probe sees the scene: `raster` draws it around every probe, with its textures; `rays` asks "
                     "the BVH once a texel, cheaper with many triangles, with mean albedos"});
    p.real("inset", inset_,
           {.min = 0,
            .max = .5,
            .unit = "grid steps",
            .cost = graph,
            .doc = "distance of the outermost probes from the sides of the scene's box"});
    p.integer("face_size", face_size_,
              {.min = 1,
               .max = 32,
               .unit = "texels",
               .scale = Scale::log,
               .cost = graph,
               .doc = "side of each of the six cube faces that a probe captures"});
    p.integer(
        "order", order_,
        {.min = 0, .max = 4, .cost = graph, .doc = "highest band of spherical harmonics; (order+1)² coefficients"});
    p.choice("basis", basis_, {"sh", "sg"},
             {.cost = graph,
              .doc = "what holds the light of a probe: spherical harmonics up to `order`, or 12 spherical Gaussians"});
    p.integer(
        "bounces", bounces_,
        {.min = 1, .max = 16, .cost = graph, .doc = "reflections before the light arrives at the visible surface"});
    p.integer("moments", moments_,
              {.min = 1,
               .max = 32,
               .unit = "texels",
               .scale = Scale::log,
               .cost = graph,
               .doc = "side of the octahedral map of distances by which a probe's visibility is judged"});
    p.real("behind", behind_,
           {.min = 0,
            .max = 1,
            .cost = graph,
            .doc = "weight, before visibility, of a probe straight behind the surface that reads it; one straight in "
                   "front has this and 1 more"});
    p.integer("emitter_rays", emitter_rays_,
              {.min = 1,
               .max = 256,
               .scale = Scale::log,
               .doc = "rays from each captured texel to all emissive triangles together (at least one each), and again "
                      "to the sky"});
    p.real("inside", inside_,
           {.min = 0,
            .max = 1,
            .unit = "of the sphere",
            .doc = "a probe that sees more than this share as backs of single-sided faces is inside of something: it "
                   "is moved out, by half a grid step at most, or switched off"});
    p.integer("budget", budget_,
              {.min = 0, .max = 1 << 18, .unit = "probes", .cost = graph, .doc = "renewed in each frame; 0 = all"});
    p.choice(
        "storage", storage_, {"fp32", "fp16"},
        {.cost = graph,
         .doc = "of the coefficients that GatherProbes reads; `fp16`: half the memory, 11 bits, and at most 65504"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.in("lights", "LightLayers").optional();
    lights.reads("shadow").reads("faces", Access::storage_read);
    auto voxels = ports.in("voxels", "VoxelScene").optional().reads("coverage").reads("radiance");
    auto readers = ports.in("readers", "Surface").optional().reads("depth");
    auto field = ports.out("field", "ProbeField");
    voxels_ = voxels.texture("coverage") != nullptr && voxels.texture("radiance") != nullptr;
    auto light = ports.in("light", "VoxelScene").optional().reads("radiance");
    has_light_ = light.texture("radiance") != nullptr;
    const bool emits = facts.emissive_triangles > 0 || facts.sky;
    if (lights.absent() && !emits && !voxels_) return field.absent("nothing shines: no light, no emitter, black sky");
    if (facts.triangles == 0) return field.absent("the scene has no triangle");
    const bool harmonics = basis_ != "sg";
    if (harmonics) bands_ = rules::bands(ports, facts, order_) + 1;
    const int coefficients = harmonics ? bands_ * bands_ : field::gaussians;
    orders_ = 1;  // voxels hold all of theirs at once
    if (!voxels_) {
      orders_ = std::min(bounces_, rules::bounces(ports, facts.max_albedo));
      rules::decide_bounces(ports, facts.max_albedo, bounces_);
    }
    channels_ = std::max(rules::channels(ports, facts), rules::channels({voxels, light}));
    grid_ = field::fit_probes(
        rules::bounds(ports, facts),
        {.probes = probes_, .inset = inset_, .coefficients = coefficients, .moments = moments_, .behind = behind_});
    decide_sleep(ports, readers);
    if (!declare_storage(ports)) return;
    const glm::ivec3 counts(grid_.counts);
    const Format stored = storage_ == "fp16" ? Format::rgba16f : Format::rgba32f;
    field.texture("coefficients",
                  TextureDesc::layers({counts.x * grid_.counts.w, counts.y}, counts.z, stored).with_channels(channels_),
                  Access::image_write);
    field.texture("moments", TextureDesc::layers({counts.x * moments_, counts.y * moments_}, counts.z, Format::rg32f),
                  Access::image_write);
    field.texture(
        "state",
        {.format = Format::rgba32f, .kind = TextureKind::d3, .width = counts.x, .height = counts.y, .depth = counts.z},
        Access::image_write);
    field.attribute("coefficients", coefficients).attribute("basis", basis_).attribute("channels", channels_);
    punctual_ = !lights.absent();
    facts_ = facts;
    // A probe may stand close to a wall. Reversed float depth loses nothing by it: near/z keeps its digits down to
    // 1e-38.
    near_ = static_cast<float>(std::max(1e-9 * glm::length(facts.bounds_max - facts.bounds_min), 1e-30));
    ports.keep_outputs(sleeps_ ? Keep::parts : Keep::whole);
    ports.decide("bounds",
                 std::to_string(counts.x) + "×" + std::to_string(counts.y) + "×" + std::to_string(counts.z) +
                     " probes, " + std::to_string(grid_.spacing.x) + " m apart",
                 rules::bounds_text(ports, facts));
  }

  void prepare(Device& device, const Bindings& bindings) override {
    const bool emits = facts_.emissive_triangles > 0;
    const std::string prefix = persistent();
    const std::vector<Define> common = {
        {"COEFFICIENTS", std::to_string(grid_.counts.w)}, {"GAUSSIANS", basis_ == "sg" ? "1" : "0"},
        {"CHANNELS", std::to_string(channels_)},          {"STATE_BLOCK", prefix + "_states"},
        {"MOMENTS_BLOCK", prefix + "_moments"},           {"ORDERS_BLOCK", prefix + "_orders"}};
    const auto program = [&](std::vector<std::string> files, std::vector<Define> defines) {
      defines.insert(defines.end(), common.begin(), common.end());
      return device.program({.files = std::move(files), .defines = std::move(defines)});
    };
    const auto capture = [&](SceneFacts facts, bool masked) {
      facts.alpha_mask = masked;  // a discard costs the early depth test
      return program({"radiance_field/capture.vert", "radiance_field/capture.geom", "radiance_field/capture.frag"},
                     scene_defines(facts));
    };
    if (capture_by_ == "rays") {
      trace_ = program({"radiance_field/trace.comp"}, scene_defines(facts_));
    } else {
      capture_ = capture(facts_, false);
      capture_masked_ = facts_.alpha_mask ? capture(facts_, true) : nullptr;
      store_ = program({"radiance_field/store.comp"}, {});
    }
    if (sleeps_) sleepers_.emplace(program({"radiance_field/readers.comp"}, {}));
    classify_ = program({"radiance_field/classify.comp"}, {});
    map_moments_ = program({"radiance_field/moments.comp"}, {});
    auto defines = scene_defines(facts_);
    defines.emplace_back("PUNCTUAL", punctual_ ? "1" : "0");
    defines.emplace_back("AREA", emits || facts_.sky ? "1" : "0");
    defines.emplace_back("SKY", facts_.sky ? "1" : "0");
    defines.emplace_back("TRACED", "1");
    const bool few = facts_.emissive_triangles <= most_integrated_emitters;
    defines.emplace_back("EMITTERS", !emits ? "EMITTERS_none" : few ? "EMITTERS_few" : "EMITTERS_many");
    light_ = voxels_ ? program({"radiance_field/look_up.comp"},
                               {{"LIGHT", has_light_ ? "light_radiance" : "voxels_radiance"}})
                     : program({"radiance_field/light.comp"}, std::move(defines));
    project_ = program({"radiance_field/project.comp"}, {});
    const auto made = [&](const char* member) { return bindings.has(member) ? "1" : "0"; };
    resolve_ = program({"radiance_field/resolve.comp"}, {{"COEFFICIENTS_OUT", made("field.coefficients")},
                                                         {"MOMENTS_OUT", made("field.moments")},
                                                         {"STATE_OUT", made("field.state")},
                                                         {"HALF", storage_ == "fp16" ? "1" : "0"}});
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    note_changes(frame);
    bindings.publish("field", grid_);
    const std::vector<float> weights =
        basis_ == "sg" ? field::gaussian_weights(face_size_) : field::texel_weights(face_size_, bands_);
    bindings.buffer("scratch.weights").write(std::as_bytes(std::span(weights)));
    update_ = sleeps_ ? sleepers_->wake(frame, bindings, grid_, what_probes_see(frame, bindings))
                      : in_turn(frame.info().index);
    if (update_.empty()) return;
    bindings.buffer("scratch.probes").write(std::as_bytes(std::span(update_)));

    place(frame, bindings);
    const int texels = 6 * face_size_ * face_size_;
    dispatch(frame, bindings, *map_moments_, {moments_ * moments_, updated(), 1});
    dispatch(frame, bindings, *light_, {texels, updated(), 1});
    frame.barrier();
    for (int reflection = 0; reflection < orders_; ++reflection) {
      project_->set("reflection", reflection);
      dispatch(frame, bindings, *project_, {64 * updated(), 1, 1});
      frame.barrier();
    }
    resolve_->set("order_count", orders_);
    dispatch(frame, bindings, *resolve_, {probe_count(), 1, 1});
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    const std::uint64_t scene = versions(frame), index = frame.info().index;
    const bool known = scene == versions_ && index >= changed_at_;
    // With a budget every frame differs from the last, until every order has had its round: each needs one more than
    // the order before.
    const auto rounds = static_cast<std::uint64_t>((probe_count() + slots() - 1) / slots());
    const std::uint64_t frames = budget_ == 0 ? 1 : rounds * static_cast<std::uint64_t>(orders_);
    return scene * 31 + (known ? std::min(index - changed_at_, frames - 1) : 0);
  }

 private:
  [[nodiscard]] int probe_count() const { return grid_.counts.x * grid_.counts.y * grid_.counts.z; }
  /// Probes that one frame renews at most, and those that this one does.
  [[nodiscard]] int updated() const { return static_cast<int>(update_.size()); }
  [[nodiscard]] int slots() const { return budget_ == 0 ? probe_count() : std::min(budget_, probe_count()); }
  /// Where the field stands while it is made: it has to outlive the frame only where the frame renews a part of it.
  [[nodiscard]] std::string persistent() const { return budget_ == 0 && !sleeps_ ? "scratch" : "persistent"; }
  [[nodiscard]] int batch() const { return std::min(slots(), max_layers / 6); }

  /// False, with a diagnostic, where a buffer would be larger than every device can bind.
  bool declare_storage(Ports& ports) const {
    const auto n = static_cast<std::size_t>(probe_count()), slot_count = static_cast<std::size_t>(slots());
    const auto coefficients = static_cast<std::size_t>(grid_.counts.w);
    const auto side = static_cast<std::size_t>(face_size_), texels = 6 * side * side;
    // Light and Texel of the shaders: std430 gives a vec3 the place of four numbers, of which Texel uses the last.
    const std::size_t light_size = channels_ == 1 ? sizeof(float) : sizeof(glm::vec4);
    const std::size_t texel_size = channels_ == 1 ? sizeof(glm::vec2) : sizeof(glm::vec4);
    const std::size_t texel_bytes = slot_count * texels * texel_size;
    const std::size_t order_bytes = static_cast<std::size_t>(orders_) * n * coefficients * light_size;
    const std::size_t moment_bytes = n * static_cast<std::size_t>(moments_ * moments_) * sizeof(glm::vec2);
    if (std::max({texel_bytes, order_bytes, moment_bytes}) > max_block_bytes) {
      ports.error("too-many-probes",
                  std::to_string(n) + " probes of " + std::to_string(texels) +
                      " texels: a buffer of the field would be larger than the 128 MiB that every device can bind",
                  "fewer probes, smaller faces, fewer bounces, or a budget");
      return false;
    }
    const auto layered = [&](Format format) {
      return TextureDesc::layers({face_size_, face_size_}, 6 * batch(), format);
    };
    if (capture_by_ == "raster") {
      ports.scratch("normals", layered(Format::rgba32f), Access::color);
      ports.scratch("surface", layered(Format::rgba32f), Access::color);
      ports.scratch("depth", layered(Format::depth32f), Access::depth);
    }
    ports.scratch("probes", BufferDesc{slot_count * sizeof(std::int32_t)});
    ports.scratch("batch", BufferDesc{slot_count * sizeof(std::int32_t)});
    ports.scratch("weights", BufferDesc{texels * coefficients * sizeof(float)});
    ports.scratch("found", BufferDesc{slot_count * sizeof(glm::vec4)});
    ports.scratch("texels", BufferDesc{texel_bytes});
    ports.scratch("surfaces", BufferDesc{slot_count * texels * sizeof(glm::uvec4)});
    const auto state = [&](std::string_view name, std::size_t bytes) {
      persistent() == "scratch" ? ports.scratch(name, BufferDesc{bytes}) : ports.persistent(name, BufferDesc{bytes});
    };
    if (sleeps_) {
      ports.scratch("read_cells", BufferDesc{n * sizeof(std::uint32_t)});
      ports.persistent("captured", BufferDesc{n * sizeof(std::uint32_t)});
    }
    state("states", n * sizeof(glm::vec4));
    state("moments", moment_bytes);
    state("orders", order_bytes);
    return true;
  }

  /// The seed places the rays.
  static std::uint64_t versions(const Frame& frame) { return scene_version(frame.scene(), frame.info().seed); }

  void decide_sleep(Ports& ports, const InputPort& readers) {
    sleeps_ = false;
    if (readers.absent() || !ports.rule("sleeping-probes")) return;
    sleeps_ = orders_ == 1 && budget_ == 0;
    ports.decide("sleeping-probes", sleeps_ ? "probes that no pixel reads are not captured" : "every probe is awake",
                 sleeps_        ? "`readers` is wired: GatherProbes reads within two grid steps of a point"
                 : budget_ != 0 ? "a budget renews all in turn"
                                : "probes light each other: each is read by others");
  }

  /// Probes in turn, by the frame's number alone: what a frame renews does not depend on what ran before.
  [[nodiscard]] std::vector<std::int32_t> in_turn(std::uint64_t index) const {
    const auto n = static_cast<std::uint64_t>(probe_count()), count = static_cast<std::uint64_t>(slots());
    std::vector<std::int32_t> probes(count);
    for (std::uint64_t slot = 0; slot < count; ++slot)
      probes[slot] = static_cast<std::int32_t>((index * count + slot) % n);
    return probes;
  }

  [[nodiscard]] std::uint64_t what_probes_see(const Frame& frame, const Bindings& bindings) const {
    std::uint64_t seen = mix_in(mix_in(versions(frame), emitter_rays_), inside_);
    for (const char* input : {"lights", "voxels", "light"}) seen = mix_in(seen, bindings.revision(input));
    return seen;
  }

  /// From when on the field of a still scene has to be renewed; after a reset, frames count from 0 again.
  void note_changes(const Frame& frame) {
    const std::uint64_t scene = versions(frame), index = frame.info().index;
    if (scene == versions_ && index > changed_at_) return;
    versions_ = scene;
    changed_at_ = index;
  }

  void dispatch(Frame& frame, const Bindings& bindings, const Program& program, glm::ivec3 threads) const {
    program.set("face_size", face_size_);
    program.set("slot_count", updated());
    frame.dispatch(program, bindings, threads);
  }

  /// Captures the geometry around every probe of the update; a probe inside something is moved out and captured again,
  /// or switched off.
  void place(Frame& frame, const Bindings& bindings) const {
    std::vector<glm::vec4> states(update_.size(), glm::vec4(0));
    std::vector<std::int32_t> entries(states.size());
    std::iota(entries.begin(), entries.end(), 0);
    const double step = field::shortest_step(grid_);
    write_states(bindings, states);
    capture(frame, bindings, entries);
    std::vector<std::int32_t> moved;
    std::vector<glm::vec4> found = classify(frame, bindings, static_cast<float>(.2 * step));
    for (std::size_t slot = 0; slot < states.size(); ++slot) {
      if (found[slot].w <= inside_) {
        states[slot].w = 1;
      } else if (glm::length(glm::vec3(found[slot])) <= .5 * step) {
        states[slot] = glm::vec4(glm::vec3(found[slot]), 1);
        moved.push_back(static_cast<std::int32_t>(slot));
      }
    }
    write_states(bindings, states);
    if (moved.empty()) return;
    capture(frame, bindings, moved);
    found = classify(frame, bindings, 0);
    for (const std::int32_t entry : moved) {
      const auto slot = static_cast<std::size_t>(entry);
      if (found[slot].w > inside_) states[slot] = glm::vec4(0);
    }
    write_states(bindings, states);
  }

  void write_states(const Bindings& bindings, const std::vector<glm::vec4>& states) const {
    const Buffer& buffer = bindings.buffer(persistent() + ".states");
    std::vector<glm::vec4> all(static_cast<std::size_t>(probe_count()));
    buffer.read(std::as_writable_bytes(std::span(all)));
    for (std::size_t slot = 0; slot < states.size(); ++slot)
      all[static_cast<std::size_t>(update_[slot])] = states[slot];
    buffer.write(std::as_bytes(std::span(all)));
  }

  std::vector<glm::vec4> classify(Frame& frame, const Bindings& bindings, float margin) const {
    classify_->set("margin", margin);
    dispatch(frame, bindings, *classify_, {updated(), 1, 1});
    frame.barrier();
    std::vector<glm::vec4> found(update_.size());
    bindings.buffer("scratch.found").read(std::as_writable_bytes(std::span(found)));
    return found;
  }

  /// Distance, normals and albedo of every texel of the probes of these slots.
  void capture(Frame& frame, const Bindings& bindings, std::span<const std::int32_t> entries) const {
    static constexpr std::array<std::string_view, 3> targets{"scratch.normals", "scratch.surface", "scratch.depth"};
    bindings.buffer("scratch.batch").write(std::as_bytes(entries));
    const int total = static_cast<int>(entries.size());
    if (trace_) {
      trace_->set("entry_count", total);
      dispatch(frame, bindings, *trace_, {6 * face_size_ * face_size_, total, 1});
      return frame.barrier();
    }
    // As many at once as a texture has layers.
    for (int first = 0; first < total; first += batch()) {
      const int count = std::min(batch(), total - first);
      frame.begin_raster(bindings, targets);
      draw(frame, bindings, *capture_, Surfaces::opaque, first, count);
      if (capture_masked_) draw(frame, bindings, *capture_masked_, Surfaces::masked, first, count);
      frame.barrier();
      store_->set("first_entry", first);
      store_->set("entry_count", count);
      dispatch(frame, bindings, *store_, {6 * face_size_ * face_size_, count, 1});
      frame.barrier();
    }
  }

  void draw(Frame& frame, const Bindings& bindings, const Program& program, Surfaces which, int first,
            int count) const {
    frame.bind(program, bindings);
    program.set("face_size", face_size_);
    program.set("slot_count", updated());
    program.set("first_entry", first);
    program.set("entry_count", count);
    program.set("near", near_);
    frame.scene().draw(program, count, which);
  }

  int probes_ = 8;
  std::string capture_by_ = "raster";
  float inset_ = .1f;
  int face_size_ = 8;
  int order_ = 2;
  std::string basis_ = "sh", storage_ = "fp32";
  int bounces_ = 6;
  int moments_ = 8;
  float behind_ = .2f;
  int emitter_rays_ = 4;
  float inside_ = .05f;
  int budget_ = 0;

  interop::ProbeGrid grid_{};
  int bands_ = 3;  ///< of spherical harmonics
  int channels_ = 3;
  int orders_ = 1;  ///< of reflection, that the probes keep apart
  bool punctual_ = false, voxels_ = false, has_light_ = false, sleeps_ = false;
  SceneFacts facts_;
  float near_ = 0;
  std::vector<std::int32_t> update_;  ///< the probes that this frame renews
  std::uint64_t versions_ = 0, changed_at_ = 0;
  std::optional<field::Sleepers> sleepers_;
  std::shared_ptr<const Program> capture_, capture_masked_, trace_, store_, classify_, map_moments_, light_, project_,
      resolve_;
};

}  // namespace

LOOM_PLUGIN("radiance_field", registry) {
  registry.add<RadianceField>("RadianceField", "Reflected light at the probes of a grid, as spherical harmonics");
}
