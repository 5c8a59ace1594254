// Which extremes are tried: ends of parameters alone and in pairs, sizes, scenes, and the laws of light.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <random>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "measure/stress.h"
#include "measure/stress_cover.h"
#include "scene/load.h"

namespace loom::measure {
namespace {

/// Whole numbers that are counts or sizes start this small, so that each can be stretched alone at little cost.
constexpr double small = 4;

std::vector<StressPart> one(View view) {
  std::vector<StressPart> parts;
  parts.push_back({.view = std::move(view)});
  return parts;
}

std::function<std::vector<StressPart>()> of(Room room) {
  return [room] { return one(make_room(room)); };
}

/// A room that has all there is: two lights, a lamp.
constexpr Room closed{.lights = 2, .lamp = 3};
/// The same without a wall, under a sky: passes that carry its light alone have nothing to do in a closed room.
constexpr Room open{.lights = 2, .lamp = 3, .open = true, .sky = 2};

bool lives_on_sky(const graph::CompiledGraph& graph) {
  return std::any_of(graph.passes.begin(), graph.passes.end(), [](const graph::CompiledPass& pass) {
    return pass.type == "PRT" || pass.type == "VisibilityField";
  });
}

/// The pipeline's plan for the room that it is tried in; `room` becomes that.
graph::CompileResult compile_for_its_room(const std::string& pipeline, const Registry& registry, Room& room,
                                          const graph::CompileOptions& options = {}) {
  room = closed;
  graph::CompileResult compiled =
      graph::compile_file(pipeline, registry, scene::compute_facts(make_room(room).scene), options);
  if (!compiled.graph || !lives_on_sky(*compiled.graph)) return compiled;
  room = open;
  return graph::compile_file(pipeline, registry, scene::compute_facts(make_room(room).scene), options);
}

/// The values at which a parameter is tried: the ends of its range. `reduced`: a count ends at 8, so that all can be
/// at their ends together.
std::vector<std::string> ends(const ParamDecl& decl, bool reduced) {
  constexpr double most = 8;
  switch (decl.kind) {
    case ParamKind::boolean:
      return {"true", "false"};
    case ParamKind::integer: {
      const double high = reduced ? std::min(decl.max, std::max(most, decl.min + 1)) : decl.max;
      return {fmt::format("{}", static_cast<long long>(decl.min)), fmt::format("{}", static_cast<long long>(high))};
    }
    case ParamKind::real:
      return {fmt::format("{}", decl.min), fmt::format("{}", decl.max)};
    case ParamKind::choice:
      return decl.choices;
    case ParamKind::colour:
      return {fmt::format("[{0}, {0}, {0}]", decl.min), fmt::format("[{0}, {0}, {0}]", decl.max)};
    case ParamKind::text:
      break;  // names of members: nothing to stretch
  }
  return {};
}

/// By how much (relative L2) a law may be missed on the small grids and with the few rays of these cases.
struct Bounds {
  double units = 1e-4, sum = 1e-3, turn = .25, light_step = .05, camera_step = 5e-3;
  bool furnace = true;
};

Bounds bounds_of(const graph::CompiledGraph& graph) {
  const auto uses = [&](std::initializer_list<std::string_view> types) {
    return std::any_of(graph.passes.begin(), graph.passes.end(), [&](const graph::CompiledPass& pass) {
      return pass.runs && std::find(types.begin(), types.end(), pass.type) != types.end();
    });
  };
  // Passes whose answer belongs to the world: what they draw by lot does not follow the pixel, and the view decides
  // nothing. Others are measured, and bound by no more than that noise is no larger than the picture.
  constexpr std::array<std::string_view, 19> of_the_world{
      "Add",           "AreaLight",    "Composite",     "DebugView",    "DirectLight", "GBuffer", "GatherProbes",
      "GatherRSM",     "GatherVolume", "Inject",        "InjectVoxels", "LPV",         "RSM",     "Radiosity",
      "RadianceField", "RayMarch",     "SurfacePoints", "Tonemap",      "Voxelize"};
  const bool world = std::all_of(graph.passes.begin(), graph.passes.end(), [&](const graph::CompiledPass& pass) {
    return !pass.runs || std::find(of_the_world.begin(), of_the_world.end(), pass.type) != of_the_world.end();
  });
  Bounds bounds;
  if (!world) bounds.sum = bounds.turn = bounds.light_step = bounds.camera_step = 1;
  // What blocks light in an injected grid is what the lights and the camera see: without one light there is less of it.
  if (uses({"Inject"})) bounds.sum = std::max(bounds.sum, 5e-2);
  // Each pixel draws its own rays; aimed ones go to what shines most, and so to other places where there is less light.
  if (uses({"RayMarch", "GatherRSM"})) {
    bounds.sum = std::max(bounds.sum, .2);
    bounds.turn = bounds.camera_step = 1;
    bounds.light_step = std::max(bounds.light_step, .2);
  }
  // A grid is fitted to its scene, so that walls lie on the faces between cells, and the last bit of a position chooses
  // the cell of each.
  if (uses({"Voxelize"})) bounds.units = 1e-2;
  // A virtual light beside a surface is as bright as it is near: the mean over many is bounded, one is not.
  if (uses({"GatherVpls"})) bounds.furnace = false;
  // Points are drawn by the order of triangles in the hierarchy, which the last bits of their boxes decide: other
  // points, and few of them here.
  if (uses({"SurfacePoints"})) bounds.units = .3;
  return bounds;
}

class Cases {
 public:
  Cases(const Registry& registry, std::map<std::string, std::set<std::string>> representatives)
      : registry_(registry), types_(std::move(representatives)) {}

  void add(const std::string& pipeline) {
    pipeline_ = pipeline;
    graph::CompileResult compiled = compile_for_its_room(pipeline, registry_, full_, {.frame_size = {16, 12}});
    if (!compiled.graph) return;  // `loom check` says why
    base_.clear();
    for (const graph::CompiledPass& pass : compiled.graph->passes) {
      for (const ParamDecl& decl : pass.params.all()) {
        if (decl.kind != ParamKind::integer || decl.cost != Cost::graph) continue;
        const double now = std::get<int>(Params::value_of(decl));
        const double reduced = std::clamp(std::min(now, small), decl.min, decl.max);
        if (reduced != now) base_.push_back({pass.name, decl.name, fmt::format("{}", static_cast<int>(reduced))});
      }
    }
    bounds_ = bounds_of(*compiled.graph);
    lengths_.clear();
    for (const graph::CompiledPass& pass : compiled.graph->passes) {
      for (const ParamDecl& decl : pass.params.all()) {
        if (!pass.runs || decl.kind != ParamKind::real || decl.unit != "m") continue;
        lengths_.push_back({pass.name, decl.name, std::get<float>(Params::value_of(decl)), decl.min, decl.max});
      }
    }
    for (const graph::CompiledPass& pass : compiled.graph->passes) {
      if (pass.runs) parameters(pass);
    }
    all_at_their_ends(compiled.graph->passes);
    storage(compiled.graph->passes);
    sizes();
    scenes();
    laws();
  }

  std::vector<StressCase> take() {
    spread();
    return std::move(cases_);
  }

 private:
  /// `candidate`: may be among the quick ones, see spread().
  StressCase& put(std::string group, std::string name, std::function<std::vector<StressPart>()> parts,
                  bool candidate = false) {
    cases_.push_back({.group = std::move(group),
                      .name = std::move(name),
                      .pipeline = pipeline_,
                      .set = base_,
                      .parts = std::move(parts),
                      .bounded = bounds_.furnace,
                      .quick = candidate && types_.contains(pipeline_)});
    return cases_.back();
  }

  /// A parameter in metres: in a scene of another unit it is another number.
  struct Length {
    std::string pass, param;
    double value, min, max;
  };

  /// One value of one parameter.
  struct End {
    const graph::CompiledPass* pass;
    const ParamDecl* decl;
    std::string value;
    [[nodiscard]] std::string text() const { return fmt::format("{}.{} = {}", pass->name, decl->name, value); }
    /// The same in every pipeline.
    [[nodiscard]] std::string kind() const { return fmt::format("{}.{} = {}", pass->type, decl->name, value); }
  };
  static void set(StressCase& made, const End& end) { made.set.push_back({end.pass->name, end.decl->name, end.value}); }

  /// Each parameter of a pass at its ends, then each two of them.
  void parameters(const graph::CompiledPass& pass) {
    std::vector<End> all;
    for (const ParamDecl& decl : pass.params.all()) {
      for (const std::string& value : ends(decl, false)) all.push_back({&pass, &decl, value});
    }
    for (const End& end : all) set(put("a parameter at an end", end.text(), of(full_)), end);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = i + 1; k < all.size(); ++k) {
        // Two values of one pass behave alike in every pipeline.
        if (all[i].decl == all[k].decl || !seen_.insert(all[i].kind() + ", " + all[k].kind()).second) continue;
        StressCase& made =
            put("two parameters of a pass at their ends", all[i].text() + ", " + all[k].text(), of(full_));
        set(made, all[i]);
        set(made, all[k]);
      }
    }
  }

  /// All parameters of the pipeline at an end at once, in so few rows that every two values meet. The quick ones come
  /// first, with the representatives: every two numbers of one pass meet. Every choice would be another program to
  /// compile, which is where the time goes.
  void all_at_their_ends(const std::vector<graph::CompiledPass>& passes) {
    std::vector<std::vector<End>> parameters;
    std::vector<int> counts, of_numbers;
    for (const graph::CompiledPass& pass : passes) {
      if (!pass.runs) continue;
      for (const ParamDecl& decl : pass.params.all()) {
        std::vector<End> values;
        for (const std::string& value : ends(decl, true)) values.push_back({&pass, &decl, value});
        if (values.empty()) continue;
        const auto count = static_cast<int>(values.size());
        const bool choice = decl.kind == ParamKind::choice || decl.kind == ParamKind::boolean;
        counts.push_back(count);
        of_numbers.push_back(choice ? 1 : count);
        parameters.push_back(std::move(values));
      }
    }
    if (parameters.size() < 2) return;
    const auto value = [&](int parameter, int index) -> const End& {
      return parameters[static_cast<std::size_t>(parameter)][static_cast<std::size_t>(index)];
    };
    const auto kinds = [&](const ValuePair& pair) {
      return value(pair.a, pair.value_a).kind() + ", " + value(pair.b, pair.value_b).kind();
    };
    using Four = std::tuple<int, int, int, int>;
    std::set<Four> met;
    int rows = 0;
    const auto add = [&](const std::vector<int>& row, bool quick) {
      StressCase& made = put(parameters_group, fmt::format("row {}", ++rows), of(full_));
      made.quick = quick;
      for (int a = 0; a < static_cast<int>(row.size()); ++a) {
        set(made, value(a, row[static_cast<std::size_t>(a)]));
        for (int b = a + 1; b < static_cast<int>(row.size()); ++b) {
          const ValuePair pair{a, row[static_cast<std::size_t>(a)], b, row[static_cast<std::size_t>(b)]};
          met.insert({pair.a, pair.value_a, pair.b, pair.value_b});
          if (quick && value(a, 0).pass == value(b, 0).pass) met_.insert(kinds(pair));
        }
      }
    };
    if (types_.contains(pipeline_)) {
      for (const std::vector<int>& row : pairwise_cover(of_numbers, 1, [&](const ValuePair& pair) {
             return value(pair.a, 0).pass == value(pair.b, 0).pass && !met_.contains(kinds(pair));
           })) {
        add(row, true);
      }
    }
    for (const std::vector<int>& row : pairwise_cover(counts, 1, [&](const ValuePair& pair) {
           return !met.contains({pair.a, pair.value_a, pair.b, pair.value_b});
         })) {
      add(row, false);
    }
  }

  /// Half floats hold 11 bits: what a volume of them shows differs by a few units of 2⁻¹¹ from what floats show.
  void storage(const std::vector<graph::CompiledPass>& passes) {
    for (const graph::CompiledPass& pass : passes) {
      const ParamDecl* decl = pass.runs ? pass.params.find("storage") : nullptr;
      if (decl == nullptr || decl->kind != ParamKind::choice) continue;
      const graph::Override single{pass.name, "storage", "fp32"}, half{pass.name, "storage", "fp16"};
      StressCase& made = put(
          storage_group, pass.name,
          [single, half, full = full_] {
            std::vector<StressPart> parts;
            parts.push_back({.view = make_room(full), .weight = 1, .set = {single}});
            parts.push_back({.view = make_room(full), .weight = -1, .set = {half}});
            return parts;
          },
          true);
      // Volumes as large as they are by themselves; maps stay small.
      std::erase_if(made.set, [](const graph::Override& set) { return set.pass != "rsm"; });
      made.tolerance = 8 * 0x1p-11;
    }
  }

  void sizes() {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), {1, 37}, {37, 1}, {3, 2}, {4096, 16}, {16, 4096}}) {
      const bool candidate = size == glm::ivec2(1, 1) || size == glm::ivec2(1, 37);
      put("size of the image", fmt::format("{}x{}", size.x, size.y), of(full_), candidate).size = size;
    }
  }

  void scenes() {
    for (const NamedView& view : odd_scenes()) {
      put(
          "odd scenes", view.name, [make = view.make] { return one(make()); }, true);
    }
    for (const int lights : {7, 64}) {
      put("number of lights", fmt::format("{}", lights), of({.lights = lights, .open = full_.open, .sky = full_.sky}),
          lights < 64);
    }
    for (const double voxels : {.1, .25, .5, 1., 2.}) {
      // The room is 4 m long; a grid of 10 has 8 cells along it and one more at each end.
      StressCase& made = put("thickness of a wall", fmt::format("{} cells", voxels),
                             of({.open = full_.open, .sky = full_.sky, .divider = voxels * .5}), voxels == .1);
      for (graph::Override& set : made.set) {
        if (set.param == "grid") set.value = "10";
      }
    }
    put("frames", "300, albedo 1", of({.albedo = 1, .lamp = 3, .open = full_.open, .sky = full_.sky})).frames = 300;
  }

  /// Σ weight · picture = 0.
  void law(std::string group, std::string name, double tolerance, std::function<std::vector<StressPart>()> parts,
           bool candidate = true) {
    put(std::move(group), std::move(name), std::move(parts), candidate).tolerance = tolerance;
  }

  static std::vector<StressPart> pair(const Room& a, double weight_a, const Room& b, double weight_b) {
    std::vector<StressPart> parts;
    parts.push_back({.view = make_room(a), .weight = weight_a});
    parts.push_back({.view = make_room(b), .weight = weight_b});
    return parts;
  }

  void laws() {
    const Room plain{.open = full_.open, .sky = full_.sky};
    for (const double factor : {1e-8, 1e-4, 2., 1e4, 1e8}) {
      Room bright = plain;
      bright.intensity = static_cast<float>(plain.intensity * factor);
      bright.sky = static_cast<float>(plain.sky * factor);
      law(
          "light ×k = picture ×k", fmt::format("{:g}", factor), 1e-3,
          [=] { return pair(bright, 1 / factor, plain, -1); }, std::abs(std::log10(factor)) > 5);
    }
    for (const double unit : {1e-3, 1e3, 1e6}) {
      Room scaled = plain;
      scaled.unit = unit;
      law(
          "units", fmt::format("×{:g}", unit), bounds_.units,
          [=, lengths = lengths_] {
            std::vector<StressPart> parts = pair(scaled, 1, plain, -1);
            for (const Length& length : lengths) {
              const double own =
                  std::clamp(length.value, length.min / std::min(unit, 1.), length.max / std::max(unit, 1.));
              parts[0].set.push_back({length.pass, length.param, fmt::format("{}", own * unit)});
              parts[1].set.push_back({length.pass, length.param, fmt::format("{}", own)});
            }
            return parts;
          },
          unit != 1e3);
    }
    Room away = plain;
    away.offset = {0x1p20, 0, -0x1p20};  // metres; half a mile more than 1e6, and whole cells of any grid
    law("far from the origin", "1.5e6 m", 1e-3, [=] { return pair(away, 1, plain, -1); });
    Room turned = plain;
    turned.quarter_turns = 1;
    law("a quarter turn", "about y", bounds_.turn, [=] { return pair(turned, 1, plain, -1); });
    law("A + B = A plus B", "a lamp and a light", bounds_.sum, [=] {
      Room lamp = plain, light = plain, both = plain;
      lamp.lights = 0;
      lamp.sky = 0;
      lamp.lamp = both.lamp = 3;
      light.lamp = 0;  // the square is there, dark
      std::vector<StressPart> parts = pair(both, 1, lamp, -1);
      parts.push_back({.view = make_room(light), .weight = -1});
      return parts;
    });
    Room stepped = plain;
    stepped.light_step = .03;  // metres: a sixteenth of half a metre
    law("a small step of a light", "3 cm", bounds_.light_step, [=] { return pair(stepped, 1, plain, -1); });
    law("a small step of the camera", "a pixel", bounds_.camera_step, [=] {
      Room flat = plain;
      flat.orthographic = true;
      std::vector<StressPart> parts;
      parts.push_back({.view = make_room(flat), .weight = 1, .shift = 1});
      parts.push_back({.view = make_room(flat), .weight = -1});
      // One pixel is 2/16 m across; all that both pictures show is the same.
      for (glm::dvec3* point : {&parts[1].view.camera.eye, &parts[1].view.camera.target}) {
        const glm::dvec3 forward = glm::normalize(parts[0].view.camera.target - parts[0].view.camera.eye);
        *point += 2. / 16 * glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
      }
      return parts;
    });
  }

  /// What every pipeline is tried with, the tests try with some of the representatives: each extreme with so many, in
  /// an order drawn by lot, that every type of pass meets it.
  void spread() {
    std::map<std::pair<std::string, std::string>, std::vector<StressCase*>> extremes;
    for (StressCase& made : cases_) {
      if (made.quick && made.group != parameters_group) extremes[{made.group, made.name}].push_back(&made);
    }
    std::mt19937 random(1);
    for (auto& [name, made] : extremes) {
      std::shuffle(made.begin(), made.end(), random);
      std::set<std::string> met;
      for (StressCase* one : made) {
        const std::set<std::string>& types = types_[one->pipeline];
        const std::size_t before = met.size();
        met.insert(types.begin(), types.end());
        one->quick = met.size() > before;
      }
    }
  }

  const Registry& registry_;
  std::string pipeline_;
  Room full_;
  std::vector<graph::Override> base_;
  Bounds bounds_;
  std::vector<Length> lengths_;
  std::map<std::string, std::set<std::string>> types_;  ///< of the passes of each representative
  std::set<std::string> seen_, met_;                    ///< pairs of values, over all pipelines
  std::vector<StressCase> cases_;
};

/// Few pipelines that have every type of pass between them, with their types: whatever brings most that is new.
std::map<std::string, std::set<std::string>> representatives(const std::vector<std::string>& pipelines,
                                                             const Registry& registry) {
  std::map<std::string, std::set<std::string>> types, chosen;
  for (const std::string& pipeline : pipelines) {
    Room room;
    const graph::CompileResult compiled = compile_for_its_room(pipeline, registry, room);
    if (!compiled.graph) continue;
    for (const graph::CompiledPass& pass : compiled.graph->passes) {
      if (pass.runs) types[pipeline].insert(pass.type);
    }
  }
  std::set<std::string> met;
  for (;;) {
    std::size_t most = 0;
    std::string best;
    for (const auto& [pipeline, its] : types) {
      const auto brings = static_cast<std::size_t>(
          std::count_if(its.begin(), its.end(), [&](const std::string& type) { return !met.contains(type); }));
      // Among equals the one with the shortest name: variants are called after what they extend.
      if (brings > most || (brings == most && brings > 0 && pipeline.size() < best.size())) {
        most = brings;
        best = pipeline;
      }
    }
    if (most == 0) return chosen;
    chosen[best] = types[best];
    met.insert(types[best].begin(), types[best].end());
  }
}

}  // namespace

std::vector<StressCase> stress_cases(const std::vector<std::string>& pipelines, const Registry& registry) {
  Cases cases(registry, representatives(pipelines, registry));
  for (const std::string& pipeline : pipelines) cases.add(pipeline);
  return cases.take();
}

}  // namespace loom::measure
