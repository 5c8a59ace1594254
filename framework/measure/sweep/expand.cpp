#include "measure/sweep/expand.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "gpu/hash.h"
#include "loom/facts.h"

namespace loom::measure {
namespace {

using json::Kind;
using json::Node;

std::string text_of(const Node& node) {
  switch (node.kind) {
    case Kind::boolean:
      return node.boolean ? "true" : "false";
    case Kind::integer:
      return std::to_string(node.integer);
    case Kind::number:
      return nlohmann::json(node.number).dump();
    case Kind::string:
      return nlohmann::json(node.string).dump();
    case Kind::array: {
      std::string text;
      for (const Node& item : node.items) text += (text.empty() ? "" : ",") + text_of(item);
      return '[' + text + ']';
    }
    default:
      return "null";
  }
}

/// The values of one knob, checked against the parameter that it turns.
class KnobValues {
 public:
  KnobValues(const Knob& knob, Params& params, Diagnostics& diagnostics)
      : knob_(knob), params_(params), decl_(params.find(knob.param)), diagnostics_(diagnostics) {}

  std::vector<std::string> operator()() {
    std::vector<Node> values = knob_.values;
    if (decl_ != nullptr && knob_.all) values = all();
    if (decl_ != nullptr && knob_.steps > 0) values = range();
    std::vector<std::string> texts;
    for (Node& value : values) {
      if (value.where.line == 0) value.where = knob_.where;
      if (!params_.set(knob_.param, value, knob_.pass, diagnostics_)) break;
      const std::string text = text_of(value);
      if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
    }
    if (decl_ == nullptr && values.empty()) params_.set(knob_.param, at(Node{}), knob_.pass, diagnostics_);
    return texts;
  }

 private:
  Node at(Node node) const {
    node.where = knob_.where;
    return node;
  }
  void refuse(const std::string& why, const std::string& hint) {
    diagnostics_.error("bad-range", '`' + knob_.pass + '.' + knob_.param + "` " + why, knob_.where, hint);
  }

  std::vector<Node> all() {
    std::vector<Node> values;
    if (decl_->kind == ParamKind::boolean) {
      for (const bool value : {false, true}) {
        Node node;
        node.kind = Kind::boolean;
        node.boolean = value;
        values.push_back(node);
      }
    } else if (decl_->kind == ParamKind::choice) {
      for (const std::string& choice : decl_->choices) {
        Node node;
        node.kind = Kind::string;
        node.string = choice;
        values.push_back(node);
      }
    } else {
      refuse("is neither a choice nor true or false, so \"all\" of it has no end", R"({ "steps": 4 } takes four)");
    }
    return values;
  }

  /// Evenly or by ratio, as the parameter's scale has it.
  std::vector<Node> range() {
    if (decl_->kind != ParamKind::integer && decl_->kind != ParamKind::real) {
      refuse("is no number, so it has no range", "list its values, or say \"all\"");
      return {};
    }
    const double from = knob_.from ? knob_.from->number : decl_->min;
    const double to = knob_.to ? knob_.to->number : decl_->max;
    const bool by_ratio = decl_->scale == Scale::log;
    if (by_ratio && (from <= 0 || to <= 0)) {
      refuse(
          "is stepped through by ratio, which has no way from " + text_of(number(from)) + " to " + text_of(number(to)),
          R"(give a "from" above 0)");
      return {};
    }
    std::vector<Node> values;
    values.reserve(static_cast<std::size_t>(knob_.steps));
    for (int i = 0; i < knob_.steps; ++i) {
      const double t = knob_.steps == 1 ? 0 : static_cast<double>(i) / (knob_.steps - 1);
      values.push_back(number(by_ratio ? from * std::pow(to / from, t) : from + t * (to - from)));
    }
    return values;
  }

  /// Four digits are enough of a step, and read well; the ends are taken as they are.
  Node number(double value) const {
    Node node;
    if (decl_->kind == ParamKind::integer) {
      node.kind = Kind::integer;
      node.integer = std::llround(value);
      node.number = static_cast<double>(node.integer);
      return node;
    }
    node.kind = Kind::number;
    const double digit = value == 0 ? 1 : std::pow(10., std::floor(std::log10(std::abs(value))) - 3);
    node.number = std::clamp(std::round(value / digit) * digit, decl_->min, decl_->max);
    node.number = nlohmann::json::parse(nlohmann::json(static_cast<float>(node.number)).dump()).get<double>();
    return node;
  }

  const Knob& knob_;
  Params& params_;
  const ParamDecl* decl_;
  Diagnostics& diagnostics_;
};

/// The grid of one entry: all combinations of its knobs' values, the first knob turning fastest.
std::vector<std::vector<graph::Override>> grid(const SweepEntry& entry, const Registry& registry,
                                               Diagnostics& diagnostics) {
  // An empty scene: what a parameter is called and how far it goes depends on none.
  graph::CompileResult result =
      graph::compile_file(entry.path, registry, SceneFacts{}, {.requested = {"hdr", "indirect"}});
  if (!result.graph) {
    diagnostics.error("bad-pipeline", '`' + entry.name + "` cannot be measured", entry.where,
                      "a pipeline that can be measured names the outputs `hdr` and `indirect`");
    diagnostics.append(result.diagnostics);
    return {};
  }
  std::vector<std::vector<graph::Override>> points = {{}};
  for (const Knob& knob : entry.knobs) {
    auto& passes = result.graph->passes;
    const auto pass = std::find_if(passes.begin(), passes.end(), [&](const auto& p) { return p.name == knob.pass; });
    if (pass == passes.end()) {
      std::vector<std::string> names;
      names.reserve(passes.size());
      for (const graph::CompiledPass& p : passes) names.push_back(p.name);
      const std::string near = nearest_name(knob.pass, names);
      diagnostics.error("unknown-pass", '`' + entry.name + "` has no pass `" + knob.pass + '`', knob.where,
                        near.empty() ? "see loom plan -p " + entry.name : "did you mean `" + near + "`?");
      continue;
    }
    std::vector<std::vector<graph::Override>> more;
    for (const std::string& value : KnobValues(knob, pass->params, diagnostics)()) {
      for (std::vector<graph::Override> point : points) {
        point.push_back({.pass = knob.pass, .param = knob.param, .value = value});
        more.push_back(std::move(point));
      }
    }
    points = std::move(more);
  }
  return points;
}

/// Everything that the sweep says about the point, in a fixed order.
std::string key_of(const Sweep& sweep, const Point& point) {
  const Settings& s = sweep.settings;
  const SweepScene& scene = sweep.scenes[point.scene];
  const glm::ivec2 size = size_of(sweep, scene);
  nlohmann::json said = {
      {"scene", scene.name},      {"camera", scene.camera}, {"pipeline", sweep.pipelines[point.entry].name},
      {"size", {size.x, size.y}}, {"samples", s.samples},   {"frames", s.frames},
      {"seeds", s.seeds},         {"static", s.keep_static}};
  for (const graph::Override& o : point.set) said["set"][o.pass + '.' + o.param] = o.value;
  if (s.truth.spp) said["spp"] = *s.truth.spp;
  if (s.truth.noise) said["noise"] = *s.truth.noise;
  if (s.flicker) {
    said["flicker"] = {s.flicker->frames, s.flicker->move.x, s.flicker->move.y, s.flicker->move.z};
  }
  return gpu::Hash128().add(said.dump()).hex().substr(0, 16);
}

}  // namespace

glm::ivec2 size_of(const Sweep& sweep, const SweepScene& scene) { return scene.size.value_or(sweep.settings.size); }

std::vector<Point> expand(const Sweep& sweep, const Registry& registry) {
  Diagnostics diagnostics;
  std::vector<std::vector<std::vector<graph::Override>>> grids;
  std::size_t longest = 0;
  for (const SweepEntry& entry : sweep.pipelines) {
    grids.push_back(grid(entry, registry, diagnostics));
    longest = std::max(longest, grids.back().size());
  }
  if (diagnostics.has_errors()) throw BadInput(diagnostics);

  std::vector<Point> points;
  for (std::size_t turn = 0; turn < longest; ++turn) {
    for (std::size_t entry = 0; entry < grids.size(); ++entry) {
      if (turn >= grids[entry].size()) continue;
      for (std::size_t scene = 0; scene < sweep.scenes.size(); ++scene) {
        Point point{.key = {}, .scene = scene, .entry = entry, .set = grids[entry][turn]};
        point.key = key_of(sweep, point);
        const auto same = [&](const Point& other) { return other.key == point.key; };
        // The same pipeline and values may stand in two grids.
        if (std::none_of(points.begin(), points.end(), same)) points.push_back(std::move(point));
      }
    }
  }
  return points;
}

std::vector<Point> shard(const std::vector<Point>& points, int i, int n) {
  std::vector<Point> share;
  for (std::size_t at = static_cast<std::size_t>(i) - 1; at < points.size(); at += static_cast<std::size_t>(n)) {
    share.push_back(points[at]);
  }
  return share;
}

}  // namespace loom::measure
