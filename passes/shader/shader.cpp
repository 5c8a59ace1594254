// Shader: a pass that is only GLSL. What a class would say in C++ stands in the pipeline:
//
//   "lit": { "type": "Shader", "file": "lit.comp", "in": { "surface": "gbuffer.surface" },
//            "ports": { "in": { "surface": "Surface" },
//                       "out": { "image": { "type": "Image", "format": "rgba16f", "size": "frame" } } },
//            "uniforms": { "k": { "default": 1, "min": 0, "max": 4, "doc": "…" } } }
//
// `file` is a compute shader, found beside the pipeline, then in the shader folders. An input is a bundle type, or
// {"type", "reads": [members], "optional"}; without `reads` it reads every member there is. An output is {"type",
// "format", "size", "quantity"} for a type of one member, or has "members": {name: {"format", "size"}}; `size` is
// "frame", [w,h] or [w,h,d]. Uniforms become parameters: a number (`float`; `int` with "type": "int"), true or false
// (`bool`), or a colour [r,g,b] (`vec3`). The shader runs over `threads`: "frame" or [x,y,z]; by default one thread a
// texel of the first output. It sees `#define HAS_<port> 1` and `HAS_<port>_<member> 1` for what there is.
#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "loom/plugin.h"

namespace {

using namespace loom;
using json::Kind;
using json::Node;

/// A size as the pipeline gives it; nothing = the frame's.
using Extent = std::optional<glm::ivec3>;

struct OutMember {
  std::string name;
  Format format = Format::rgba16f;
  Extent size;
};
struct OutSpec {
  std::string name, type, quantity;
  std::vector<OutMember> members;
};
struct InSpec {
  std::string name, type;
  bool optional = false;
  std::optional<std::vector<std::string>> reads;
};
struct Uniform {
  std::string name;
  ParamKind kind = ParamKind::real;
  bool boolean = false;
  int integer = 0;
  float real = 0;
  glm::vec3 colour{0};
  double min = 0, max = 0;
  std::string unit, doc;
  Scale scale = Scale::linear;
};

/// Reads the pass's own keys; every fault becomes a diagnostic at its place.
class Reader {
 public:
  Reader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void wrong(const Node& at, std::string message, std::string hint = {}) {
    diagnostics_.error("shader-pass", std::move(message), at.where, std::move(hint));
  }

  /// False (and a diagnostic) where `node` is not an object or has a key beside `keys`.
  bool object(const Node& node, std::string_view what, const std::vector<std::string>& keys) {
    if (!node.is(Kind::object)) {
      wrong(node, std::string(what) + " must be an object, not " + std::string(json::to_string(node.kind)));
      return false;
    }
    for (const auto& member : node.members) {
      if (std::find(keys.begin(), keys.end(), member.key) != keys.end()) continue;
      const auto near = nearest_name(member.key, keys);
      diagnostics_.error("unknown-key", std::string(what) + " has no key \"" + member.key + "\"", member.key_where,
                         near.empty() ? "" : "did you mean \"" + near + "\"?");
    }
    return true;
  }

  std::string text(const Node& node, std::string_view what) {
    if (!node.is(Kind::string)) wrong(node, std::string(what) + " must be a string");
    return node.string;
  }

  Format format(const Node& node) {
    const auto found = format_from(text(node, "format"));
    if (!found) wrong(node, "unknown format \"" + node.string + "\"", "one of rgba8, rgba16f, rgba32f, r16f, r32f, …");
    if (found && is_depth(*found)) wrong(node, "a compute shader cannot write " + node.string, "use r32f");
    return found.value_or(Format::rgba16f);
  }

  Extent extent(const Node& node, std::string_view what) {
    if (node.is(Kind::string) && node.string == "frame") return std::nullopt;
    const bool sized = node.is(Kind::array) && (node.items.size() == 2 || node.items.size() == 3);
    glm::ivec3 size(1);
    for (std::size_t i = 0; sized && i < node.items.size(); ++i) {
      const Node& item = node.items[i];
      if (!item.is(Kind::integer) || item.integer < 1 || item.integer > 16384) {
        wrong(item, std::string(what) + " must be integers from 1 to 16384");
        return std::nullopt;
      }
      size[static_cast<int>(i)] = static_cast<int>(item.integer);
    }
    if (!sized) wrong(node, std::string(what) + " must be \"frame\", [width, height] or [width, height, depth]");
    return sized ? Extent(size) : std::nullopt;
  }

  InSpec input(const json::Member& entry) {
    InSpec in{.name = entry.key};
    if (entry.value.is(Kind::string)) {
      in.type = entry.value.string;
      return in;
    }
    if (!object(entry.value, "input \"" + entry.key + "\"", {"type", "reads", "optional"})) return in;
    if (const Node* type = entry.value.find("type"))
      in.type = text(*type, "type");
    else
      wrong(entry.value, "input \"" + entry.key + R"(" needs a "type")");
    if (const Node* optional = entry.value.find("optional")) in.optional = optional->boolean;
    if (const Node* reads = entry.value.find("reads")) {
      if (!reads->is(Kind::array)) wrong(*reads, "reads must be a list of member names");
      in.reads.emplace();
      for (const Node& item : reads->items) in.reads->push_back(text(item, "a member"));
    }
    return in;
  }

  OutSpec output(const json::Member& entry) {
    OutSpec out{.name = entry.key};
    const std::string what = "output \"" + entry.key + "\"";
    if (!object(entry.value, what, {"type", "format", "size", "quantity", "members"})) return out;
    if (const Node* type = entry.value.find("type"))
      out.type = text(*type, "type");
    else
      wrong(entry.value, what + " needs a \"type\"");
    if (const Node* quantity = entry.value.find("quantity")) out.quantity = text(*quantity, "quantity");
    if (const Node* members = entry.value.find("members")) {
      if (!members->is(Kind::object)) wrong(*members, "members must be an object");
      for (const auto& member : members->members) {
        if (!object(member.value, "member \"" + member.key + "\"", {"format", "size"})) continue;
        out.members.push_back(member_of(member.key, member.value));
      }
      return out;
    }
    const auto& known = builtin_bundles();
    const auto type = std::find_if(known.begin(), known.end(), [&](const auto& t) { return t.name == out.type; });
    if (type == known.end() || type->members.size() != 1) {
      wrong(entry.value, what + " of type " + out.type + " must name its members",
            R"(add "members": { "<member>": { "format": "rgba16f", "size": "frame" } })");
    } else {
      out.members.push_back(member_of(type->members.front().name, entry.value));
    }
    return out;
  }

  Uniform uniform(const json::Member& entry) {
    Uniform u{.name = entry.key};
    const std::string what = "uniform \"" + entry.key + "\"";
    if (!object(entry.value, what, {"default", "min", "max", "doc", "unit", "scale", "type"})) return u;
    const Node* value = entry.value.find("default");
    if (value == nullptr) {
      wrong(entry.value, what + " needs a \"default\"");
      return u;
    }
    const Node* type = entry.value.find("type");
    const bool integer = type != nullptr && type->string == "int";
    if (type != nullptr && !integer && type->string != "float") wrong(*type, R"(type must be "int" or "float")");
    u.min = bound(entry.value, "min", what, !value->is(Kind::boolean));
    u.max = bound(entry.value, "max", what, !value->is(Kind::boolean));
    if (const Node* doc = entry.value.find("doc")) u.doc = text(*doc, "doc");
    if (const Node* unit = entry.value.find("unit")) u.unit = text(*unit, "unit");
    if (const Node* scale = entry.value.find("scale")) {
      if (scale->string != "log" && scale->string != "linear") wrong(*scale, R"(scale must be "linear" or "log")");
      if (scale->string == "log") u.scale = Scale::log;
    }
    const auto in_range = [&](const Node& item) {
      if (!item.is_number())
        wrong(item, "the default of " + what + " must be a number, true, false or [r, g, b]");
      else if (item.number < u.min || item.number > u.max)
        wrong(item, "the default of " + what + " is out of its range");
      return static_cast<float>(item.number);
    };
    if (value->is(Kind::boolean)) {
      u.kind = ParamKind::boolean;
      u.boolean = value->boolean;
    } else if (value->is(Kind::array) && value->items.size() == 3) {
      u.kind = ParamKind::colour;
      for (int i = 0; i < 3; ++i) u.colour[i] = in_range(value->items[static_cast<std::size_t>(i)]);
    } else if (integer) {
      u.kind = ParamKind::integer;
      if (!value->is(Kind::integer)) wrong(*value, "the default of " + what + " must be an integer");
      in_range(*value);
      u.integer = static_cast<int>(value->integer);
    } else {
      u.real = in_range(*value);
    }
    return u;
  }

 private:
  OutMember member_of(const std::string& name, const Node& node) {
    OutMember member{.name = name};
    if (const Node* f = node.find("format")) member.format = format(*f);
    if (const Node* s = node.find("size")) member.size = extent(*s, "size");
    return member;
  }

  double bound(const Node& node, std::string_view key, const std::string& what, bool needed) {
    const Node* value = node.find(key);
    if (value != nullptr && value->is_number()) return value->number;
    if (needed)
      wrong(node, what + " needs a number \"" + std::string(key) + "\"", "a range keeps --set and sweeps in bounds");
    return 0;
  }

  Diagnostics& diagnostics_;
};

TextureDesc texture_of(const OutMember& member, glm::ivec2 frame) {
  if (!member.size) return TextureDesc::image(frame, member.format);
  TextureDesc desc = TextureDesc::image(glm::ivec2(*member.size), member.format);
  if (member.size->z > 1) {
    desc.kind = TextureKind::d3;
    desc.depth = member.size->z;
    desc.filter = is_integer(member.format) ? Filter::nearest : Filter::linear;
  }
  return desc;
}

class Shader final : public Pass {
 public:
  [[nodiscard]] std::span<const std::string_view> own_keys() const override {
    static constexpr std::array<std::string_view, 4> keys{"file", "ports", "uniforms", "threads"};
    return keys;
  }

  void configure(const Node& pass, Diagnostics& diagnostics) override {
    Reader read(diagnostics);
    if (const Node* file = pass.find("file"); file == nullptr) {
      read.wrong(pass, "a Shader pass needs a \"file\"", R"("file": "my.comp", beside the pipeline)");
    } else if (file_ = read.text(*file, "file"); !file_.ends_with(".comp")) {
      read.wrong(*file, "\"" + file_ + "\" is not a compute shader", "name a file that ends in .comp");
    } else {
      const auto beside = std::filesystem::path(file->where.file).parent_path() / file_;
      std::error_code ignored;
      if (std::filesystem::exists(beside, ignored))
        file_ = std::filesystem::absolute(beside).lexically_normal().string();
    }
    if (const Node* ports = pass.find("ports"); ports == nullptr) {
      read.wrong(pass, "a Shader pass needs \"ports\"",
                 R"("ports": { "in": {}, "out": { "image": { "type": "Image" } } })");
    } else if (read.object(*ports, "ports", {"in", "out"})) {
      if (const Node* in = ports->find("in")) {
        for (const auto& entry : in->members) inputs_.push_back(read.input(entry));
      }
      if (const Node* out = ports->find("out")) {
        for (const auto& entry : out->members) outputs_.push_back(read.output(entry));
      }
      if (outputs_.empty()) read.wrong(*ports, "a Shader pass needs at least one output");
    }
    if (const Node* uniforms = pass.find("uniforms")) {
      if (!uniforms->is(Kind::object)) read.wrong(*uniforms, "uniforms must be an object");
      for (const auto& entry : uniforms->members) uniforms_.push_back(read.uniform(entry));
    }
    if (const Node* threads = pass.find("threads")) {
      over_frame_ = threads->is(Kind::string);
      threads_ = read.extent(*threads, "threads");
    }
  }

  void params(Params& p) override {
    for (Uniform& u : uniforms_) {  // a deque: the addresses stay
      const RealOptions real{.min = u.min, .max = u.max, .unit = u.unit, .scale = u.scale, .doc = u.doc};
      switch (u.kind) {
        case ParamKind::boolean:
          p.boolean(u.name, u.boolean, {.doc = u.doc});
          break;
        case ParamKind::integer:
          p.integer(u.name, u.integer,
                    {.min = static_cast<int>(u.min),
                     .max = static_cast<int>(u.max),
                     .unit = u.unit,
                     .scale = u.scale,
                     .doc = u.doc});
          break;
        case ParamKind::colour:
          p.colour(u.name, u.colour, real);
          break;
        default:
          p.real(u.name, u.real, real);
      }
    }
  }

  void reflect(Ports& ports, const SceneFacts&) override {
    defines_.clear();
    std::optional<std::string> absent;
    for (const InSpec& spec : inputs_) {
      auto in = ports.in(spec.name, spec.type);
      if (spec.optional) in.optional();
      if (spec.reads) {
        for (const auto& member : *spec.reads) in.reads(member);
      } else {
        in.reads_all();
      }
      if (in.absent()) {
        if (!spec.optional && !absent) absent = in.why_absent();
        continue;
      }
      defines_.emplace_back("HAS_" + spec.name, "1");
      for (const MemberDecl& member : in.info()->members) {
        const bool read = !spec.reads || std::ranges::find(*spec.reads, member.name) != spec.reads->end();
        if (read) defines_.emplace_back("HAS_" + spec.name + "_" + member.name, "1");
      }
    }
    for (const OutSpec& spec : outputs_) {
      auto out = ports.out(spec.name, spec.type);
      if (absent) {
        out.absent(*absent);
        continue;
      }
      for (const OutMember& member : spec.members) {
        out.texture(member.name, texture_of(member, ports.frame_size()), Access::image_write);
      }
      if (!spec.quantity.empty()) out.attribute("quantity", spec.quantity);
    }
    const bool frame_wide = over_frame_ || outputs_.empty() || outputs_.front().members.empty();
    const Extent size = threads_ ? threads_ : frame_wide ? Extent{} : outputs_.front().members.front().size;
    run_over_ = size.value_or(glm::ivec3(ports.frame_size(), 1));
  }

  void prepare(Device& device, const Bindings& bindings) override {
    auto defines = defines_;
    for (const OutSpec& spec : outputs_) {
      for (const OutMember& member : spec.members) {
        const std::string name = spec.name + "." + member.name;
        if (bindings.has(name)) defines.emplace_back("HAS_" + spec.name + "_" + member.name, "1");
      }
    }
    program_ = device.program({.files = {file_}, .defines = std::move(defines)});
  }

  void execute(Frame& frame, const Bindings& bindings) override { frame.dispatch(*program_, bindings, run_over_); }

 private:
  std::string file_;
  std::vector<InSpec> inputs_;
  std::vector<OutSpec> outputs_;
  std::deque<Uniform> uniforms_;
  bool over_frame_ = false;
  Extent threads_;
  std::vector<Define> defines_;
  glm::ivec3 run_over_{1};
  std::shared_ptr<const Program> program_;
};

}  // namespace

LOOM_PLUGIN("shader", registry) {
  registry.add<Shader>("Shader", "A compute shader with its ports and uniforms in the pipeline");
}
