// Voxelize: the whole scene in a grid, by one rasterised pass, lit.
//
// Each triangle is projected along the axis that it faces most (its dominant axis; Crassin and Green, "Octree-Based
// Sparse Voxelization Using the GPU Hardware Rasterizer", OpenGL Insights, 2012), over every column of cells that its
// bounding box touches, and each fragment cuts it to the cells of its column. So the area that a cell gets is exact,
// and a triangle of any size is in some cell. (`slicing` has the two cheaper ways of G. Papaioannou, "Real-time Global
// Illumination", 2011, beside it.) A cell keeps one *sheet* an axis: of the triangles that face that axis
// most the mean plane, the rectangle that they span, the opaque share of it (area × alpha over the section of the
// plane), and for either side albedo, emission and position. The two sides of a wall thinner than a cell stay apart.
//
// Every side of every sheet is then lit: radiance after one reflection, L = ρ/π·(E_direct + E_emitter), with shadow
// maps where `lights` are wired and rays through the voxels where not.
//
// What no animation moves is added up once: each frame starts from those sums and adds what can move. Sums are
// integers, so that the result is the same to the bit.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "interop/grid.h"
#include "loom/fingerprint.h"
#include "loom/grid.h"
#include "loom/plugin.h"
#include "loom/rounds.h"
#include "loom/rules.h"

namespace {

using namespace loom;

// As in shaders/voxelize/sums.glsl.
constexpr int sum_rows = 27;
constexpr int emission_rows = 6;
// As in shaders/voxelize/geometry.geom: what one run of the stage may put out ends there.
constexpr int slices_a_run = 4;
const std::vector<std::string> combinations{"sum", "or", "max"};

class Voxelize final : public Pass {
 public:
  void params(Params& p) override {
    p.integer("grid", grid_,
              {.min = 1,
               .max = 128,
               .unit = "cells",
               .scale = Scale::log,
               .cost = Cost::graph,
               .doc = "cells along the longest side of the scene's box"});
    p.choice("slicing", slicing_, {"area", "fragment", "geometry"},
             {.cost = Cost::shader,
              .doc = "how triangles are cut into cells: `area`: exactly; `fragment`: each fragment of the rasterised "
                     "triangle goes to the slice of its depth; `geometry`: the geometry stage cuts it into slices"});
    p.choice("combine", combine_, combinations,
             {.cost = Cost::graph,
              .doc = "what of a sheet is opaque: `sum`: what its pieces' areas add up to; `or`: all of the cell's "
                     "section, wherever there is anything; `max`: the largest piece's area"});
    p.choice("channels", channels_, {"colour", "luminance"},
             {.cost = Cost::graph,
              .doc = "of albedo, emission and radiance; a scene without colour takes `luminance` by itself"});
    p.choice("storage", storage_, {"fp32", "fp16"},
             {.cost = Cost::graph,
              .doc = "of emission and radiance, and of what Radiosity makes of it; `fp16`: half the memory, 11 bits, "
                     "and at most 65504 W/(m² sr)"});
    p.integer("rays", rays_,
              {.min = 1,
               .max = 256,
               .scale = Scale::log,
               .doc = "rays a side of a sheet to emissive triangles, and again to the sky"});
  }

  void reflect(Ports& ports, const SceneFacts& facts) override {
    auto lights = ports.in("lights", "LightLayers").optional();
    lights.reads("shadow").reads("faces", Access::storage_read);
    auto voxels = ports.out("voxels", "VoxelScene");
    if (facts.triangles == 0) return voxels.absent("the scene has no triangle");
    facts_ = facts;
    facts_.normal_maps = false;  // sheets are triangles
    shadow_maps_ = !lights.absent();
    grid_block_ = fit_grid(rules::bounds(ports, facts), grid_);

    reflect_volumes(ports, voxels);
    check_rays(ports);

    // The raster has no picture; its size is that of a target.
    ports.scratch("raster", TextureDesc::image({raster_size(), raster_size()}, Format::r8), Access::color);
    if (!emits()) ports.decide("no-emission", "no emission in the voxels", "no surface emits");
    reflect_sums(ports);
  }

  void prepare(Device& device, const Bindings& bindings) override {
    emission_ = bindings.has("voxels.emission");
    const auto operation = std::find(combinations.begin(), combinations.end(), combine_) - combinations.begin();
    const auto made = [&](const char* member) { return bindings.has(std::string("voxels.") + member) ? "1" : "0"; };
    const std::vector<Define> layout{{"SUM_ROWS", std::to_string(rows())},    {"EMISSION", emission_ ? "1" : "0"},
                                     {"CENTROID", made("centroid")},          {"ALBEDO", made("albedo")},
                                     {"RADIANCE", made("radiance")},          {"GREY", grey_ ? "1" : "0"},
                                     {"LUMINANCE", achromatic_ ? "0" : "1"},  {"COMBINE", std::to_string(operation)},
                                     {"HALF", storage_ == "fp16" ? "1" : "0"}};
    auto scene = scene_defines(facts_);
    if (slicing_ == "geometry")
      scene.emplace_back("INVOCATIONS", std::to_string((raster_size() + slices_a_run - 1) / slices_a_run));
    const auto into = [&](const char* sums, std::vector<Define> defines) {
      defines.insert(defines.end(), layout.begin(), layout.end());
      defines.emplace_back("SUMS", sums);
      return defines;
    };
    const auto drawing = [&](const char* sums) {
      const std::string stage = "voxelize/" + slicing_;
      return device.program(
          {.files = {"voxelize/voxelize.vert", stage + ".geom", stage + ".frag"}, .defines = into(sums, scene)});
    };
    still_ = keeps_still_ ? drawing("persistent_still") : nullptr;
    voxelize_ = draws_moving() ? drawing("scratch_sums") : nullptr;
    resolve_ = device.program({.files = {"voxelize/resolve.comp"},
                               .defines = into(draws_moving() ? "scratch_sums" : "persistent_still", {})});
    still_sums_of_.reset();
    light_ = nullptr;
    if (bindings.has("voxels.radiance")) {
      std::vector<Define> defines{{"GREY", grey_ ? "1" : "0"},
                                  {"HALF", storage_ == "fp16" ? "1" : "0"},
                                  {"LUMINANCE", achromatic_ ? "0" : "1"},
                                  {"PUNCTUAL", facts_.lights() > 0 ? "1" : "0"},
                                  {"SHADOW_MAPS", shadow_maps_ ? "1" : "0"},
                                  {"EMITTERS", emits() ? "1" : "0"},
                                  {"SKY", facts_.sky ? "1" : "0"}};
      if (facts_.sky_image) defines.emplace_back("SCENE_SKY_IMAGE", "1");
      light_ = device.program({.files = {"voxelize/light.comp"}, .defines = std::move(defines)});
    }
  }

  void execute(Frame& frame, const Bindings& bindings) override {
    bindings.publish("voxels", grid_block_);
    if (keeps_still_) add_still(frame, bindings);
    if (draws_moving()) {
      const Buffer& sums = bindings.buffer("scratch.sums");
      keeps_still_ ? sums.copy(bindings.buffer("persistent.still")) : sums.clear();
      add(frame, bindings, *voxelize_, keeps_still_ ? Motion::moving : Motion::any);
    }
    if (emission_) resolve_->set("max_emission", static_cast<float>(facts_.max_emission));
    const glm::ivec3 cells(grid_block_.cells);
    frame.dispatch(*resolve_, bindings, cells);
    frame.barrier();
    if (light_) frame.dispatch(*light_, bindings, {cells.x, cells.y, 6 * cells.z});
  }

  [[nodiscard]] Fingerprint fingerprint(const Frame& frame) const override {
    return scene_version(frame.scene(), frame.info().seed);  // the seed places the rays
  }

 private:
  /// All light of a side is found by one invocation (loom/rounds.h); on an average way through a room a ray takes some
  /// four rounds for each cell along the grid's side.
  void check_rays(Ports& ports) const {
    const int kinds = (facts_.emissive_triangles > 0 ? 1 : 0) + (facts_.sky ? 1 : 0);
    const int to_lights = shadow_maps_ ? 0 : 16 * facts_.lights();
    const double rounds = 4. * grid_ * (kinds * rays_ + to_lights);
    if (rounds <= most_rounds) return;
    ports.error("too-many-rays",
                std::to_string(kinds * rays_ + to_lights) + " rays a side of a sheet through a grid of " +
                    std::to_string(grid_) + " cells are more than one shader invocation can follow",
                to_lights > 0 ? "wire `lights` to an RSM: its shadow maps take the place of rays"
                              : "set fewer `rays`, or a coarser `grid`");
  }

  /// The volumes that consumers may ask for. Light needs the places of the sheets; the albedo that it takes away from
  /// what it makes is laid down in the volume that it makes.
  void reflect_volumes(Ports& ports, OutputPort& voxels) {
    achromatic_ = rules::channels(ports, facts_) == 1;
    grey_ = achromatic_ || channels_ == "luminance";
    voxels.attribute("channels", grey_ ? 1 : 3).attribute("max_albedo", facts_.max_albedo);
    const auto volume = [&](const char* member, Format format, int slabs) {
      voxels.texture(member, cell_texture(grid_block_, format, slabs), Access::image_write);
    };
    const auto by_side = [&](const char* member, Format colour, Format grey) {
      TextureDesc desc = cell_texture(grid_block_, grey_ ? grey : colour, 6);
      desc.grey = grey_;
      voxels.texture(member, desc, Access::image_read_write);
    };
    volume("coverage", Format::rgba16f, 1);
    volume("plane", Format::rgba16f, 3);
    volume("extent", Format::rgba8, 3);
    for (const char* member : {"coverage", "plane", "extent"}) voxels.needed(member);
    volume("centroid", Format::rgba16f, 6);
    voxels.needed("centroid", "radiance");
    by_side("albedo", Format::rgba16f, Format::rg16f);
    const bool half = storage_ == "fp16";
    const Format colour = half ? Format::rgba16f : Format::rgba32f, grey = half ? Format::r16f : Format::r32f;
    if (emits()) by_side("emission", colour, grey);
    by_side("radiance", colour, grey);
  }

  /// What moves is known here; what has moved since, when a frame runs.
  void reflect_sums(Ports& ports) {
    const bool rule = ports.rule("static");
    keeps_still_ = facts_.moves && facts_.moving_triangles < facts_.triangles && rule;
    const std::size_t cells = static_cast<std::size_t>(grid_block_.cells.x) * grid_block_.cells.y * grid_block_.cells.z;
    const BufferDesc sums{.bytes = 3 * cells * static_cast<std::size_t>(rows()) * sizeof(std::int32_t)};
    if (draws_moving()) ports.scratch("sums", sums);
    if (keeps_still_) {
      ports.persistent("still", sums);
      ports.decide(
          "static", "what stands still is voxelized once",
          std::to_string(facts_.moving_triangles) + " of " + std::to_string(facts_.triangles) + " triangles move");
    } else if (!facts_.moves && rule) {
      ports.keep_outputs();
      ports.decide("static", "voxelized and lit once", "nothing in the scene moves");
    }
  }

  /// Adds surfaces to the sums.
  void add(Frame& frame, const Bindings& bindings, const Program& program, Motion motion) const {
    static constexpr std::string_view raster = "scratch.raster";
    frame.begin_raster(bindings, {&raster, 1});
    program.set("raster_size", static_cast<float>(raster_size()));
    if (emission_) program.set("inverse_max_emission", static_cast<float>(1 / facts_.max_emission));
    frame.bind(program, bindings);
    frame.scene().draw(program, 1, Surfaces::all, motion);
    frame.barrier();
  }

  /// The sums of what stands still, where they are not those of an earlier frame.
  void add_still(Frame& frame, const Bindings& bindings) {
    const bool after_reset = frame.info().index == 0 && frame.info().sample == 0;
    const std::uint64_t now = frame.scene().still_version();
    if (!after_reset && still_sums_of_ == now) return;
    bindings.buffer("persistent.still").clear();
    add(frame, bindings, *still_, Motion::still);
    still_sums_of_ = now;
  }

  [[nodiscard]] int rows() const { return sum_rows + (emits() ? emission_rows : 0) + (combine_ == "max" ? 1 : 0); }
  [[nodiscard]] bool draws_moving() const { return !keeps_still_ || facts_.moving_triangles > 0; }
  [[nodiscard]] bool emits() const { return facts_.emissive_triangles > 0 && facts_.max_emission > 0; }
  [[nodiscard]] int raster_size() const {
    return std::max({grid_block_.cells.x, grid_block_.cells.y, grid_block_.cells.z});
  }

  int grid_ = 32, rays_ = 32;
  std::string slicing_ = "area", combine_ = "sum", channels_ = "colour", storage_ = "fp32";
  bool shadow_maps_ = false, emission_ = false;
  bool grey_ = false;                           // one channel
  bool achromatic_ = false;                     // since all are equal, and not for their luminance
  bool keeps_still_ = false;                    // persistent.still holds the sums of what no animation moves
  std::optional<std::uint64_t> still_sums_of_;  // the still_version() that it holds
  SceneFacts facts_;
  interop::Grid grid_block_{};
  std::shared_ptr<const Program> still_, voxelize_, resolve_, light_;
};

}  // namespace

LOOM_PLUGIN("voxelize", registry) {
  registry.add<Voxelize>("Voxelize", "The whole scene in a grid: sheets with coverage, material and reflected light");
}
