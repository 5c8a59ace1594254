// Stage 5: do the wires fit, and does every pass declare what its bundle types can hold?
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "graph/compile/draft.h"

namespace loom::graph {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

template <class Decl>
std::vector<std::string> names_of(const std::vector<Decl>& decls) {
  std::vector<std::string> names;
  names.reserve(decls.size());
  for (const auto& decl : decls) names.push_back(decl.name);
  return names;
}

class Validation {
 public:
  explicit Validation(Draft& draft) : draft_(draft), out_(*draft.diagnostics) {}

  void run() {
    for (const auto& pass : draft_.passes) {
      for (const auto& wire : pass.wires) check_wire(pass, wire);
      if (!pass.reflected) continue;
      check_inputs(pass);
      check_outputs(pass);
      check_state(pass);
      if (!pass.doubtful)
        for (const auto& issue : pass.ports.issues)
          out_.error(issue.code, "`" + pass.name() + "`: " + issue.message, pass.entry->where, issue.hint);
    }
    check_targets();
  }

 private:
  [[nodiscard]] static std::string quoted(const DraftPass& pass, std::string_view port) {
    return '`' + pass.name() + '.' + std::string(port) + '`';
  }

  void check_wire(const DraftPass& pass, const Wire& wire) {
    const InputDecl* input = pass.reflected ? pass.input(wire.entry->input) : nullptr;
    if (pass.reflected && input == nullptr) {
      std::string hint = name_hint(wire.entry->input, names_of(pass.ports.inputs));
      if (pass.ports.inputs.empty()) hint = pass.type->name + " takes no inputs";
      out_.error("unknown-port",
                 "pass `" + pass.name() + "` (" + pass.type->name + ") has no input `" + wire.entry->input + '`',
                 wire.entry->key_where, std::move(hint));
    }
    if (wire.from_pass != none) {
      const DraftPass& producer = draft_.passes[at(wire.from_pass)];
      if (producer.reflected && producer.output(wire.entry->from.port) == none) {
        unknown_output(producer, wire.entry->from.port,
                       quoted(pass, wire.entry->input) + " is wired to `" + wire.entry->text + '`', wire.entry->where);
        return;
      }
    }
    if (wire.external != none && wire.entry->from.history) return;  // reported by the parser
    if (input == nullptr || wire.version == none) return;
    const BundleInfo& info = draft_.versions[at(wire.version)].info;
    if (input->type == "*" || info.type.empty() || info.type == input->type) return;
    out_.error("bundle-mismatch",
               quoted(pass, input->name) + " takes " + described(*input) + ", but `" + wire.entry->text + "` carries " +
                   carries(info),
               wire.entry->where, sources_hint(pass, input->type));
  }

  /// "ShVolume (red, green)" by what the input reads.
  [[nodiscard]] static std::string described(const InputDecl& input) {
    std::string text = input.type;
    for (std::size_t i = 0; i < input.reads.size(); ++i) text += (i == 0 ? " (reads " : ", ") + input.reads[i].member;
    return input.reads.empty() ? text : text + ')';
  }

  void unknown_output(const DraftPass& producer, const std::string& port, const std::string& message,
                      const SourceLocation& where) {
    std::string hint = name_hint(port, names_of(producer.ports.outputs));
    if (producer.ports.outputs.empty()) hint = producer.type->name + " makes nothing";
    out_.error(
        "unknown-output",
        message + ", but pass `" + producer.name() + "` (" + producer.type->name + ") has no output `" + port + '`',
        where, std::move(hint));
  }

  /// Which outputs of the graph carry that type, for whoever looks for one.
  [[nodiscard]] std::string sources_hint(const DraftPass& consumer, const std::string& type) const {
    std::string list;
    for (const auto& producer : draft_.passes) {
      if (!producer.reflected || &producer == &consumer) continue;
      for (const auto& output : producer.ports.outputs)
        if (type == "*" || output.type == type) list += (list.empty() ? "" : ", ") + quoted(producer, output.name);
    }
    for (const auto& external : draft_.externals)
      if (type == "*" || external.info.type == type)
        list += (list.empty() ? "`inputs." : ", `inputs.") + external.entry->name + '`';
    return list.empty() ? "no pass of this pipeline makes " + type : type + " comes from " + list;
  }

  void check_inputs(const DraftPass& pass) {
    for (std::size_t i = 0; i < pass.ports.inputs.size(); ++i) {
      const InputDecl& input = pass.ports.inputs[i];
      const std::string port = quoted(pass, input.name);
      for (std::size_t j = 0; j < i; ++j)
        if (pass.ports.inputs[j].name == input.name) twice(pass, "input", input.name);
      if (!input.optional && !names_input(pass, input.name))
        out_.error("missing-input", "input " + port + " (" + described(input) + ") is not wired", pass.entry->where,
                   sources_hint(pass, input.type));
      if (input.type == "*") continue;
      const BundleType* type = known_bundle(pass, port, input.type);
      if (type == nullptr) continue;
      for (const auto& read : input.reads) {
        if (type->find(read.member) == nullptr) unknown_member(pass, port + " reads", *type, read.member);
        if (writes(read.access) && !draft_.takes_in_place(pass, input.name))
          out_.error("undeclared-write",
                     port + " declares " + std::string(to_string(read.access)) + " of `" + read.member +
                         "`, but no output takes it over",
                     pass.entry->where,
                     "a pass that changes its input declares an output in_place(\"" + input.name + "\")");
      }
    }
  }

  /// Also true for a wire that was left out because its value is wrong: that was reported.
  [[nodiscard]] static bool names_input(const DraftPass& pass, const std::string& input) {
    if (pass.wire(input) != nullptr) return true;
    const json::Node* in = pass.entry->node.find("in");
    if (in != nullptr && !in->is(json::Kind::object)) return true;
    const json::Node* value = in == nullptr ? nullptr : in->find(input);
    return value != nullptr && !value->is(json::Kind::null);
  }

  void check_outputs(const DraftPass& pass) {
    for (std::size_t i = 0; i < pass.ports.outputs.size(); ++i) {
      const OutputDecl& output = pass.ports.outputs[i];
      const std::string port = quoted(pass, output.name);
      for (std::size_t j = 0; j < i; ++j)
        if (pass.ports.outputs[j].name == output.name) twice(pass, "output", output.name);
      const BundleType* type = known_bundle(pass, port, output.type);
      check_through(pass, output);
      for (std::size_t m = 0; m < output.members.size(); ++m) {
        const MemberDecl& member = output.members[m];
        for (std::size_t j = 0; j < m; ++j)
          if (output.members[j].name == member.name) twice(pass, "member", output.name + '.' + member.name);
        check_resource(pass, output.name + '.' + member.name, member);
        if (type == nullptr) continue;
        const BundleMember* known = type->find(member.name);
        if (known == nullptr)
          unknown_member(pass, port + " makes", *type, member.name);
        else if ((known->kind == MemberKind::buffer) != std::holds_alternative<BufferDesc>(member.desc))
          out_.error("member-kind",
                     port + " makes `" + member.name + "` as a " +
                         (known->kind == MemberKind::buffer ? "texture" : "buffer") + ", but in " + type->name +
                         " it is a " + (known->kind == MemberKind::buffer ? "buffer" : "texture"),
                     pass.entry->where);
      }
    }
  }

  void check_through(const DraftPass& pass, const OutputDecl& output) {
    for (const auto* through : {&output.forwards, &output.in_place}) {
      if (!*through) continue;
      const std::string doing = through == &output.forwards ? "forwards" : "changes";
      const InputDecl* input = pass.input(**through);
      const Wire* wire = pass.wire(**through);
      std::string wrong;
      if (input == nullptr)
        wrong = "which is none of its inputs";
      else if (wire != nullptr && wire->history())
        wrong = "which is a last frame's value";
      else if (input->type != "*" && input->type != output.type)
        wrong = "which is " + input->type;
      if (!wrong.empty())
        out_.error("bad-forward",
                   quoted(pass, output.name) + " (" + output.type + ") " + doing + " `" + **through + "`, " + wrong,
                   pass.entry->where);
    }
  }

  void check_state(const DraftPass& pass) {
    const auto check = [&](const std::vector<MemberDecl>& decls, const std::string& owner) {
      for (std::size_t i = 0; i < decls.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j)
          if (decls[j].name == decls[i].name) twice(pass, owner, decls[i].name);
        check_resource(pass, owner + '.' + decls[i].name, decls[i]);
      }
    };
    check(pass.ports.scratches, "scratch");
    check(pass.ports.persistents, "persistent");
  }

  void check_resource(const DraftPass& pass, const std::string& path, const MemberDecl& decl) {
    const auto wrong = [&](const std::string& why) {
      out_.error("bad-resource", quoted(pass, path) + ": " + why, pass.entry->where);
    };
    if (const auto* buffer = std::get_if<BufferDesc>(&decl.desc)) {
      if (buffer->bytes == 0) wrong("a buffer of no bytes");
      if (decl.access != Access::storage_read && decl.access != Access::storage_write)
        wrong("a buffer cannot be accessed as " + std::string(to_string(decl.access)));
      return;
    }
    const auto& texture = std::get<TextureDesc>(decl.desc);
    // The least that OpenGL 4.5 grants every implementation.
    const bool volume = texture.kind == TextureKind::d3;
    const int max_side = volume ? 2048 : 16384;
    constexpr int max_layers = 2048;
    const auto inside = [](int n, int most) { return n >= 1 && n <= most; };
    if (!inside(texture.width, max_side) || !inside(texture.height, max_side) || !inside(texture.depth, max_layers) ||
        !inside(texture.mips, 15))
      wrong(to_string(texture) + " is outside 1 … " + std::to_string(max_side) + " texels a side, 1 … " +
            std::to_string(max_layers) + " layers");
    if (texture.kind == TextureKind::d2 && texture.depth != 1) wrong("a 2D texture has one layer");
    if (texture.kind == TextureKind::cube && texture.depth != 6) wrong("a cube has six layers");
    if (texture.kind == TextureKind::cube_array && texture.depth % 6 != 0) wrong("a cube array has six layers a cube");
    const bool as_depth = decl.access == Access::depth;
    if (as_depth != is_depth(texture.format) && writes(decl.access))
      wrong(std::string(to_string(texture.format)) + " cannot be accessed as " + std::string(to_string(decl.access)));
    if (decl.access == Access::storage_read || decl.access == Access::storage_write)
      wrong("a texture cannot be accessed as " + std::string(to_string(decl.access)));
    if (is_integer(texture.format) && texture.filter == Filter::linear) wrong("integers cannot be filtered linearly");
  }

  void twice(const DraftPass& pass, const std::string& what, const std::string& name) {
    out_.error("duplicate-port",
               pass.type->name + " (`" + pass.name() + "`) declares " + what + " `" + name + "` twice",
               pass.entry->where);
  }

  const BundleType* known_bundle(const DraftPass& pass, const std::string& port, const std::string& name) {
    const BundleType* type = draft_.registry->bundle(name);
    if (type == nullptr)
      out_.error("unknown-bundle", port + " is of bundle type `" + name + "`, which nobody declares", pass.entry->where,
                 name_hint(name, names_of(draft_.registry->bundles())));
    return type;
  }

  void unknown_member(const DraftPass& pass, const std::string& doing, const BundleType& type,
                      const std::string& member) {
    out_.error("unknown-member", doing + " `" + member + "`, which the bundle type " + type.name + " does not have",
               pass.entry->where, name_hint(member, names_of(type.members)));
  }

  void check_targets() {
    std::vector<Target> of_file;
    for (const auto& output : draft_.document->outputs) {
      Target target{.name = output.name, .endpoint = output.text, .where = output.where};
      if (!output.from)
        target.absent = "the pipeline makes no `" + output.name + '`';
      else
        find_target(target, *output.from, "output `" + output.name + "`");
      of_file.push_back(std::move(target));
    }
    if (draft_.options->requested.empty()) {
      draft_.targets = std::move(of_file);
      return;
    }
    for (const auto& name : draft_.options->requested) {
      const auto named =
          std::find_if(of_file.begin(), of_file.end(), [&](const Target& target) { return target.name == name; });
      if (named != of_file.end()) {
        draft_.targets.push_back(*named);
        continue;
      }
      Target target{.name = name, .endpoint = name, .where = {draft_.document->file, 0, 0, {}}};
      const auto endpoint = endpoint_from(name);
      if (endpoint && !endpoint->history) {
        find_target(target, *endpoint, "the output asked for, `" + name + "`,");
      } else {
        std::string hint = name_hint(name, names_of(of_file));
        out_.error("unknown-target", "the pipeline has no output `" + name + '`', target.where,
                   (hint.empty() ? "" : hint + " ") + "`pass.port` and `pass.port.member` can be asked for too");
      }
      draft_.targets.push_back(std::move(target));
    }
  }

  void find_target(Target& target, const Endpoint& from, const std::string& what) {
    if (from.external()) {
      for (const auto& external : draft_.externals)
        if (external.entry->name == from.port) target.version = external.version;
      if (target.version == none)
        out_.error("unknown-input", what + " is `" + target.endpoint + "`, which the pipeline does not declare",
                   target.where);
    } else {
      const DraftPass* pass = draft_.pass(from.pass);
      if (pass == nullptr) {
        out_.error("unknown-pass", what + " is `" + target.endpoint + "`, but there is no pass `" + from.pass + '`',
                   target.where, name_hint(from.pass, draft_.pass_names()));
        return;
      }
      if (!pass->reflected) return;
      const int output = pass->output(from.port);
      if (output == none) {
        unknown_output(*pass, from.port, what + " is `" + target.endpoint + '`', target.where);
        return;
      }
      target.version = pass->versions[at(output)];
    }
    if (target.version != none) find_member(target, from, what);
  }

  void find_member(Target& target, const Endpoint& from, const std::string& what) {
    const BundleInfo& info = draft_.versions[at(target.version)].info;
    const BundleType* type = draft_.registry->bundle(info.type);
    if (type == nullptr || type->members.empty()) return;
    target.member = from.member.empty() ? type->members.front().name : from.member;
    target.quantity = target.member;
    if (const auto quantity = info.attributes.find("quantity"); quantity != info.attributes.end())
      if (const auto* text = std::get_if<std::string>(&quantity->second)) target.quantity = *text;
    target.absent = info.absent;
    const BundleMember* member = type->find(target.member);
    if (member == nullptr) {
      out_.error("unknown-member",
                 what + " is `" + target.endpoint + "`, but " + type->name + " has no member `" + target.member + '`',
                 target.where, name_hint(target.member, names_of(type->members)));
      return;
    }
    if (info.absent) return;
    if (member->kind == MemberKind::buffer && !draft_.options->request_buffers) {
      out_.error("not-an-image", what + " is the buffer `" + target.endpoint + "`, which cannot be shown", target.where,
                 "it carries " + carries(info));
      return;
    }
    const bool made = std::any_of(info.members.begin(), info.members.end(),
                                  [&](const MemberDecl& decl) { return decl.name == target.member; });
    // Whether a member is made may depend on the scene, so its absence is no mistake of the pipeline.
    if (!made) target.absent = '`' + draft_.version_name(target.version) + "` has no `" + target.member + "` here";
  }

  Draft& draft_;
  Diagnostics& out_;
};

}  // namespace

void validate(Draft& draft) { Validation(draft).run(); }

}  // namespace loom::graph
