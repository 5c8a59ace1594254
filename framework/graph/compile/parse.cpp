// Stage 1, second half: from the merged object to passes, wires and outputs.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "graph/compile/document.h"
#include "loom/diagnostic.h"
#include "loom/json.h"

namespace loom::graph {
namespace {

// Every text that the compiler takes ends in bounded time: some of its steps are quadratic in the passes.
constexpr std::size_t max_passes = 1024;

using json::Kind;
using json::Member;
using json::Node;

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

class Reader {
 public:
  explicit Reader(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  bool expect(const Node& node, Kind kind, const std::string& what) {
    if (node.is(kind)) return true;
    diagnostics_.error("wrong-type",
                       what + " takes " + std::string(json::to_string(kind)) + ", but this is " +
                           std::string(json::to_string(node.kind)),
                       node.where);
    return false;
  }

  void check_keys(const Node& object, std::span<const std::string_view> known, const std::string& owner) {
    for (const auto& member : object.members) {
      if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
      diagnostics_.error("unknown-key", owner + " has no key `" + member.key + '`', member.key_where,
                         name_hint(member.key, {known.begin(), known.end()}));
    }
  }

  bool check_name(const Member& member, const std::string& what) {
    const bool reserved = member.key == "inputs" || member.key == "scratch" || member.key == "persistent";
    if (is_name(member.key) && !reserved) return true;
    diagnostics_.error("bad-name", "`" + member.key + "` cannot name " + what, member.key_where,
                       reserved ? "this word has a meaning of its own in paths" : "names are made of a-z, 0-9 and _");
    return false;
  }

  std::string text(const Node& object, std::string_view key) {
    const Node* node = object.find(key);
    if (node == nullptr || !expect(*node, Kind::string, '`' + std::string(key) + '`')) return {};
    return node->string;
  }

  InputEntry input(const Member& member) {
    static constexpr std::array<std::string_view, 4> keys = {"type", "format", "size", "summary"};
    InputEntry entry{.name = member.key, .where = member.key_where};
    check_keys(member.value, keys, "input `" + member.key + '`');
    entry.type = text(member.value, "type");
    entry.format = text(member.value, "format");
    if (const Node* type = member.value.find("type"))
      entry.type_where = type->where;
    else
      diagnostics_.error("missing-key", "input `" + member.key + "` has no `type`", member.key_where,
                         R"(say which bundle the program supplies: "type": "Image")");
    if (const Node* format = member.value.find("format")) entry.format_where = format->where;
    if (const Node* size = member.value.find("size"); size != nullptr && !(size->string == "frame")) {
      const auto side = [](const Node& n) { return n.is(Kind::integer) && n.integer > 0 && n.integer <= 16384; };
      if (size->items.size() == 2 && side(size->items[0]) && side(size->items[1])) {
        entry.width = static_cast<int>(size->items[0].integer);
        entry.height = static_cast<int>(size->items[1].integer);
      } else {
        diagnostics_.error("wrong-type", "`size` takes \"frame\" or [width, height] in 1 … 16384 texels", size->where);
      }
    }
    return entry;
  }

  void wires(const Node& in, PassEntry& pass) {
    for (const auto& member : in.members) {
      if (member.value.is(Kind::null)) continue;
      if (!expect(member.value, Kind::string, "input `" + pass.name + '.' + member.key + '`')) continue;
      auto from = endpoint_from(member.value.string);
      if (!from || !from->member.empty() || (from->external() && from->history)) {
        std::string hint = R"(a wire is "pass.port", "pass.port@prev" or "inputs.name")";
        if (from && !from->member.empty())
          hint = "a wire carries a whole bundle: \"" + from->pass + '.' + from->port + '"';
        else if (from)
          hint = "the program keeps last frames of its own textures itself";
        diagnostics_.error(
            "bad-endpoint",
            "`" + member.value.string + "` is not what input `" + pass.name + '.' + member.key + "` can be wired to",
            member.value.where, std::move(hint));
        continue;
      }
      pass.wires.push_back({member.key, member.value.string, std::move(*from), member.key_where, member.value.where});
    }
  }

  PassEntry pass(Member&& member) {
    PassEntry entry;
    entry.name = std::move(member.key);
    entry.where = std::move(member.key_where);
    entry.node = std::move(member.value);
    const std::string quoted = '`' + entry.name + '`';
    if (const Node* type = entry.node.find("type")) {
      if (expect(*type, Kind::string, "`type` of " + quoted)) entry.type = type;
    } else {
      diagnostics_.error("missing-key", "pass " + quoted + " has no `type`", entry.where,
                         "`loom passes` lists the types there are");
    }
    if (const Node* summary = entry.node.find("summary")) expect(*summary, Kind::string, "`summary` of " + quoted);
    if (const Node* in = entry.node.find("in"); in != nullptr && expect(*in, Kind::object, "`in` of " + quoted))
      wires(*in, entry);
    if (const Node* params = entry.node.find("params");
        params != nullptr && expect(*params, Kind::object, "`params` of " + quoted))
      for (const auto& param : params->members)
        if (!param.value.is(Kind::null)) entry.params.push_back(&param);
    return entry;
  }

  void output(const Member& member, std::vector<OutputEntry>& outputs) {
    OutputEntry entry{.name = member.key, .key_where = member.key_where, .where = member.value.where};
    if (!member.value.is(Kind::null)) {
      if (!member.value.is(Kind::string)) {
        diagnostics_.error("wrong-type",
                           "output `" + member.key + "` takes \"pass.port\" or null, but this is " +
                               std::string(json::to_string(member.value.kind)),
                           member.value.where);
        return;
      }
      entry.text = member.value.string;
      entry.from = endpoint_from(entry.text);
      if (!entry.from || entry.from->history) {
        diagnostics_.error("bad-endpoint", "`" + entry.text + "` is not what output `" + member.key + "` can be",
                           entry.where, R"(an output is "pass.port" or "pass.port.member" of this frame, or null)");
        return;
      }
    }
    outputs.push_back(std::move(entry));
  }

 private:
  Diagnostics& diagnostics_;
};

}  // namespace

std::string name_hint(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t few = 12;
  const std::string near = nearest_name(name, candidates);
  if (!near.empty()) return "did you mean `" + near + "`?";
  if (candidates.empty() || candidates.size() > few) return {};
  std::string list;
  for (const auto& candidate : candidates) list += (list.empty() ? "`" : ", `") + candidate + '`';
  return (candidates.size() == 1 ? "there is " : "there are ") + list;
}

std::optional<Endpoint> endpoint_from(std::string_view text) {
  Endpoint endpoint;
  if (const auto at = text.find('@'); at != std::string_view::npos) {
    if (text.substr(at) != "@prev") return std::nullopt;
    endpoint.history = true;
    text = text.substr(0, at);
  }
  std::array<std::string*, 3> parts = {&endpoint.pass, &endpoint.port, &endpoint.member};
  std::size_t count = 0;
  while (count < parts.size()) {
    const auto dot = text.find('.');
    const auto part = text.substr(0, dot);
    if (!is_name(part)) return std::nullopt;
    *parts[count++] = std::string(part);
    if (dot == std::string_view::npos) return count >= 2 ? std::optional(endpoint) : std::nullopt;
    text.remove_prefix(dot + 1);
  }
  return std::nullopt;
}

Document read_document(Loaded loaded, const std::string& file, Diagnostics& diagnostics) {
  static constexpr std::array<std::string_view, 8> keys = {"$schema", "name",   "summary", "measured",
                                                           "extends", "inputs", "passes",  "outputs"};
  Document document;
  document.file = file;
  document.files = std::move(loaded.files);
  Reader reader(diagnostics);
  Node& root = loaded.root;
  reader.check_keys(root, keys, "a pipeline");
  reader.text(root, "$schema");
  document.name = reader.text(root, "name");
  document.summary = reader.text(root, "summary");
  // What `loom tune` found of this very file: for people and other programs.
  if (const Node* measured = root.find("measured")) reader.expect(*measured, Kind::object, "`measured`");
  document.outputs_where = root.where;
  for (auto& section : root.members) {
    if (section.key == "inputs" && reader.expect(section.value, Kind::object, "`inputs`")) {
      for (const auto& member : section.value.members)
        if (!member.value.is(Kind::null) && reader.check_name(member, "an input") &&
            reader.expect(member.value, Kind::object, "input `" + member.key + '`'))
          document.inputs.push_back(reader.input(member));
    } else if (section.key == "passes" && reader.expect(section.value, Kind::object, "`passes`")) {
      if (section.value.members.size() > max_passes) {
        diagnostics.error("too-many-passes",
                          "a pipeline may have " + std::to_string(max_passes) + " passes, this one has " +
                              std::to_string(section.value.members.size()),
                          section.key_where);
        continue;
      }
      document.passes.reserve(section.value.members.size());
      for (auto& member : section.value.members)
        if (!member.value.is(Kind::null) && reader.check_name(member, "a pass") &&
            reader.expect(member.value, Kind::object, "pass `" + member.key + '`'))
          document.passes.push_back(reader.pass(std::move(member)));
    } else if (section.key == "outputs" && reader.expect(section.value, Kind::object, "`outputs`")) {
      document.outputs_where = section.key_where;
      for (const auto& member : section.value.members)
        if (reader.check_name(member, "an output")) reader.output(member, document.outputs);
    }
  }
  if (root.find("passes") == nullptr)
    diagnostics.error("missing-key", "a pipeline has no `passes`", root.where,
                      "\"passes\": { \"name\": { \"type\": … } }");
  const auto image = std::find_if(document.outputs.begin(), document.outputs.end(),
                                  [](const OutputEntry& output) { return output.name == "image"; });
  const Node* outputs = root.find("outputs");
  const bool named = outputs != nullptr && outputs->find("image") != nullptr;  // wrong values are reported above
  if ((image == document.outputs.end() && !named) || (image != document.outputs.end() && !image->from))
    diagnostics.error("missing-image", "the pipeline makes no `image`", document.outputs_where,
                      R"(every pipeline names what it shows: "outputs": { "image": "tonemap.image" })");
  return document;
}

}  // namespace loom::graph
