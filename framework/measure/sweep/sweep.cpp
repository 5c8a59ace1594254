#include "measure/sweep/sweep.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace loom::measure {
namespace {

namespace fs = std::filesystem;
using json::Kind;
using json::Node;

constexpr int max_size = 16384;  // pixels a side, what OpenGL 4.5 guarantees

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "`" : ", `") + word + '`';
  return text;
}

class Reader {
 public:
  Reader(const std::string& file, const Names& names, Diagnostics& diagnostics)
      : folder_(fs::path(file).parent_path()), names_(names), diagnostics_(diagnostics) {}

  Sweep sweep(const Node& root) {
    Sweep sweep;
    if (!object(root, "a sweep",
                {"$schema", "name", "summary", "scenes", "pipelines", "size", "samples", "frames", "seeds", "static",
                 "reference", "flicker"}))
      return sweep;
    sweep.name = text(root.find("name"), "name");
    sweep.summary = text(root.find("summary"), "summary");
    Settings& settings = sweep.settings;
    if (const auto size = this->size(root.find("size"))) settings.size = *size;
    settings.samples = whole(root.find("samples"), "samples", 1, 65536, settings.samples);
    settings.frames = whole(root.find("frames"), "frames", 1, 100000, settings.frames);
    settings.seeds = whole(root.find("seeds"), "seeds", 1, 1000, settings.seeds);
    if (const Node* keep = root.find("static"); keep != nullptr && expect(*keep, Kind::boolean, "`static`"))
      settings.keep_static = keep->boolean;
    if (const Node* reference = root.find("reference")) settings.truth = truth(*reference);
    if (const Node* path = root.find("flicker"); path != nullptr && !path->is(Kind::null)) {
      settings.flicker = flicker(*path);
    }
    for (const Node& item : items(root, "scenes", "scenes")) {
      if (auto found = scene(item)) sweep.scenes.push_back(std::move(*found));
    }
    for (const Node& item : items(root, "pipelines", "pipelines")) {
      if (auto found = pipeline(item)) sweep.pipelines.push_back(std::move(*found));
    }
    return sweep;
  }

 private:
  void error(const Node& node, std::string code, std::string message, std::string hint = {}) {
    diagnostics_.error(std::move(code), std::move(message), node.where, std::move(hint));
  }

  bool expect(const Node& node, Kind kind, const std::string& what) {
    if (node.is(kind)) return true;
    error(node, "wrong-type",
          what + " takes " + std::string(json::to_string(kind)) + ", but this is " +
              std::string(json::to_string(node.kind)));
    return false;
  }

  bool object(const Node& node, const std::string& what, const std::vector<std::string>& keys) {
    if (!expect(node, Kind::object, what)) return false;
    for (const json::Member& member : node.members) {
      if (std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
      const std::string near = nearest_name(member.key, keys);
      diagnostics_.error("unknown-key", what + " has no key `" + member.key + '`', member.key_where,
                         near.empty() ? "it may have " + list_of(keys) : "did you mean `" + near + "`?");
    }
    return true;
  }

  std::string text(const Node* node, const std::string& what) {
    return node != nullptr && expect(*node, Kind::string, '`' + what + '`') ? node->string : std::string();
  }

  int whole(const Node* node, const std::string& what, int least, int most, int otherwise) {
    if (node == nullptr || !expect(*node, Kind::integer, '`' + what + '`')) return otherwise;
    if (node->integer >= least && node->integer <= most) return static_cast<int>(node->integer);
    error(*node, "out-of-range",
          '`' + what + "` is " + std::to_string(node->integer) + ", outside " + std::to_string(least) + " … " +
              std::to_string(most));
    return otherwise;
  }

  std::optional<double> positive(const Node* node, const std::string& what) {
    if (node == nullptr) return std::nullopt;
    if (node->is_number() && node->number > 0) return node->number;
    error(*node, "wrong-type", '`' + what + "` takes a number above 0");
    return std::nullopt;
  }

  std::optional<glm::ivec2> size(const Node* node) {
    if (node == nullptr) return std::nullopt;
    const auto side = [](const Node& n) { return n.is(Kind::integer) && n.integer >= 1 && n.integer <= max_size; };
    if (node->is(Kind::array) && node->items.size() == 2 && side(node->items[0]) && side(node->items[1])) {
      return glm::ivec2(node->items[0].integer, node->items[1].integer);
    }
    error(*node, "wrong-type", "`size` takes [width, height], each 1 … " + std::to_string(max_size) + " pixels");
    return std::nullopt;
  }

  TruthTarget truth(const Node& node) {
    TruthTarget target;
    if (!object(node, "`reference`", {"spp", "noise"})) return target;
    if (const Node* spp = node.find("spp")) {
      target.spp = static_cast<std::uint32_t>(whole(spp, "spp", 16, 1 << 28, 1024));
    }
    target.noise = positive(node.find("noise"), "noise");
    if (target.spp.has_value() == target.noise.has_value()) {
      error(node, "missing-key", "`reference` takes either `spp` or `noise`", R"("reference": { "spp": 1024 })");
    }
    return target;
  }

  FlickerPath flicker(const Node& node) {
    FlickerPath path;
    if (!object(node, "`flicker`", {"frames", "move"})) return path;
    path.frames = whole(node.find("frames"), "frames", 4, 10000, path.frames);
    if (const Node* move = node.find("move")) {
      const auto number = [](const Node& n) { return n.is_number(); };
      if (move->is(Kind::array) && move->items.size() == 3 &&
          std::all_of(move->items.begin(), move->items.end(), number)) {
        path.move = {move->items[0].number, move->items[1].number, move->items[2].number};
      } else {
        error(*move, "wrong-type", "`move` takes [right, up, forward], shares of the scene's diagonal a frame");
      }
    }
    return path;
  }

  const std::vector<Node>& items(const Node& root, const std::string& key, const std::string& what) {
    static const std::vector<Node> none;
    const Node* list = root.find(key);
    if (list == nullptr || (list->is(Kind::array) && list->items.empty())) {
      diagnostics_.error("missing-key", "a sweep names no " + what, list == nullptr ? root.where : list->where,
                         R"("scenes": ["cornell-box"], "pipelines": ["lpv"])");
      return none;
    }
    return expect(*list, Kind::array, '`' + key + '`') ? list->items : none;
  }

  /// The file of that name beside the sweep, else what `find` makes of it.
  std::string resolve(const Node& node, const std::function<std::string(const std::string&)>& find) {
    std::error_code ignored;
    const fs::path beside = folder_ / node.string;
    if (fs::is_regular_file(beside, ignored)) return beside.string();
    try {
      return find(node.string);
    } catch (const BadInput& problem) {
      Diagnostic first = problem.diagnostics().all().front();
      first.where = node.where;
      diagnostics_.add(std::move(first));
      return {};
    }
  }

  std::optional<SweepScene> scene(const Node& node) {
    const Node* name = &node;
    SweepScene scene;
    if (node.is(Kind::object)) {
      object(node, "a scene", {"scene", "size", "camera"});
      name = node.find("scene");
      scene.size = size(node.find("size"));
      if (const Node* camera = node.find("camera")) scene.camera = text(camera, "camera");
    }
    if (name == nullptr) {
      error(node, "missing-key", "a scene has no `scene`", R"({ "scene": "cornell-box", "size": [256, 256] })");
      return std::nullopt;
    }
    if (!expect(*name, Kind::string, "a scene")) return std::nullopt;
    scene.name = name->string;
    scene.path = resolve(*name, names_.scene);
    return scene;
  }

  std::optional<SweepEntry> pipeline(const Node& node) {
    const Node* name = &node;
    SweepEntry entry;
    entry.where = node.where;
    if (node.is(Kind::object)) {
      object(node, "a pipeline of a sweep", {"pipeline", "set"});
      name = node.find("pipeline");
      if (const Node* set = node.find("set"); set != nullptr && expect(*set, Kind::object, "`set`")) {
        for (const json::Member& member : set->members) {
          if (auto found = knob(member)) entry.knobs.push_back(std::move(*found));
        }
      }
    }
    if (name == nullptr) {
      error(node, "missing-key", "there is no `pipeline` here",
            R"({ "pipeline": "lpv", "set": { "lpv.iterations": [4, 8] } })");
      return std::nullopt;
    }
    if (!expect(*name, Kind::string, "a pipeline")) return std::nullopt;
    entry.name = name->string;
    entry.path = resolve(*name, names_.pipeline);
    return entry;
  }

  std::optional<Knob> knob(const json::Member& member) {
    Knob knob;
    knob.where = member.key_where;
    const std::size_t dot = member.key.find('.');
    if (dot == std::string::npos || dot == 0 || dot + 1 == member.key.size()) {
      diagnostics_.error("bad-parameter", '`' + member.key + "` is no pass.parameter", member.key_where,
                         R"(for example "lpv.iterations": [4, 8, 16])");
      return std::nullopt;
    }
    knob.pass = member.key.substr(0, dot);
    knob.param = member.key.substr(dot + 1);
    const Node& value = member.value;
    if (value.is(Kind::array)) {
      if (value.items.empty()) error(value, "wrong-type", '`' + member.key + "` lists no value");
      knob.values = value.items;
    } else if (value.is(Kind::object)) {
      object(value, '`' + member.key + '`', {"from", "to", "steps"});
      knob.steps = whole(value.find("steps"), "steps", 1, 10000, 3);
      for (auto [key, end] : {std::pair("from", &knob.from), std::pair("to", &knob.to)}) {
        const Node* node = value.find(key);
        if (node == nullptr) continue;
        if (node->is_number()) {
          *end = *node;
        } else {
          error(*node, "wrong-type", std::string("`") + key + "` takes a number");
        }
      }
    } else if (value.is(Kind::string) && value.string == "all") {
      knob.all = true;
    } else {
      knob.values = {value};
    }
    return knob;
  }

  fs::path folder_;
  const Names& names_;
  Diagnostics& diagnostics_;
};

}  // namespace

Sweep read_sweep(const std::string& path, const Names& names) {
  Diagnostics diagnostics;
  const Node root = json::parse_file(path, diagnostics);
  Sweep sweep;
  if (!diagnostics.has_errors()) sweep = Reader(path, names, diagnostics).sweep(root);
  if (diagnostics.has_errors()) throw BadInput(diagnostics);
  sweep.file = path;
  if (sweep.name.empty()) sweep.name = fs::path(path).stem().string();
  return sweep;
}

}  // namespace loom::measure
