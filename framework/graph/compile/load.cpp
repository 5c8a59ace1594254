// Stage 1, first half: read a pipeline file and merge it over the one it extends.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "graph/compile/document.h"
#include "loom/diagnostic.h"
#include "loom/json.h"

namespace loom::graph {
namespace {

using json::Kind;
using json::Member;
using json::Node;

/// Sets or adds one key; the key's place goes along with the value's.
void put(Node& object, Member member) {
  for (auto& old : object.members) {
    if (old.key != member.key) continue;
    old = std::move(member);
    return;
  }
  object.members.push_back(std::move(member));
}

void erase(Node& object, std::string_view key) {
  std::erase_if(object.members, [&](const Member& m) { return m.key == key; });
}

Node* find(Node& object, std::string_view key) {
  for (auto& member : object.members)
    if (member.key == key) return &member.value;
  return nullptr;
}

/// One level: null takes a key out, anything else replaces it.
void merge_entries(Node& base, Node over) {
  for (auto& member : over.members) {
    if (member.value.is(Kind::null))
      erase(base, member.key);
    else
      put(base, std::move(member));
  }
}

bool both_objects(const Node* a, const Node& b) { return a != nullptr && a->is(Kind::object) && b.is(Kind::object); }

/// A pass of another type inherits nothing: parameters and wiring of the old one mean nothing to it.
bool changes_type(const Node& base, const Node& over) {
  const Node* to = over.find("type");
  const Node* from = base.find("type");
  return to != nullptr && (from == nullptr || from->string != to->string);
}

void merge_pass(Node& base, Node over) {
  for (auto& member : over.members) {
    Node* old = find(base, member.key);
    if ((member.key == "in" || member.key == "params") && both_objects(old, member.value))
      merge_entries(*old, std::move(member.value));
    else if (member.value.is(Kind::null))
      erase(base, member.key);
    else
      put(base, std::move(member));
  }
}

void merge_passes(Node& base, Node over) {
  for (auto& member : over.members) {
    Node* old = find(base, member.key);
    if (member.value.is(Kind::null))
      erase(base, member.key);
    else if (both_objects(old, member.value) && !changes_type(*old, member.value))
      merge_pass(*old, std::move(member.value));
    else if (old != nullptr)
      *old = std::move(member.value);
    else
      base.members.push_back(std::move(member));
  }
}

Node merged(Node base, Node over) {
  erase(base, "extends");
  erase(base, "measured");  // of the base, not of what is made of it
  for (auto& member : over.members) {
    Node* old = find(base, member.key);
    if (member.key == "passes" && both_objects(old, member.value)) {
      merge_passes(*old, std::move(member.value));
    } else if (member.key == "inputs" && both_objects(old, member.value)) {
      merge_entries(*old, std::move(member.value));
    } else if (member.key == "outputs" && both_objects(old, member.value)) {
      for (auto& output : member.value.members) put(*old, std::move(output));  // null is a value here: it makes none
    } else if (member.value.is(Kind::null)) {
      erase(base, member.key);
    } else {
      put(base, std::move(member));
    }
  }
  base.where = over.where;
  return base;
}

std::string canonical(const std::string& path) {
  std::error_code error;
  const auto full = std::filesystem::weakly_canonical(path, error);
  return error ? path : full.string();
}

struct Link {
  std::string path, canonical;
};

Node with_base(Node root, const std::string& file, std::vector<Link>& chain, std::vector<std::string>& files,
               Diagnostics& diagnostics);

Node from_file(const std::string& path, std::vector<Link>& chain, std::vector<std::string>& files,
               Diagnostics& diagnostics) {
  files.push_back(path);
  return with_base(json::parse_file(path, diagnostics), path, chain, files, diagnostics);
}

Node with_base(Node root, const std::string& file, std::vector<Link>& chain, std::vector<std::string>& files,
               Diagnostics& diagnostics) {
  if (root.is(Kind::null) && diagnostics.has_errors()) return {};
  if (!root.is(Kind::object)) {
    diagnostics.error("wrong-type", "a pipeline is an object, but this is " + std::string(json::to_string(root.kind)),
                      root.where);
    return {};
  }
  const Node* extends = root.find("extends");
  if (extends == nullptr || extends->is(Kind::null)) return root;
  if (!extends->is(Kind::string)) {
    diagnostics.error(
        "wrong-type",
        "`extends` takes the path of a pipeline, but this is " + std::string(json::to_string(extends->kind)),
        extends->where);
    return {};
  }
  const std::string base_path = (std::filesystem::path(file).parent_path() / extends->string).string();
  chain.push_back({file, canonical(file)});
  const std::string base_canonical = canonical(base_path);
  const auto loop =
      std::find_if(chain.begin(), chain.end(), [&](const Link& link) { return link.canonical == base_canonical; });
  if (loop != chain.end()) {
    std::string path;
    for (auto it = loop; it != chain.end(); ++it) path += '`' + it->path + "` extends ";
    diagnostics.error("extends-loop", path + '`' + base_path + "` again", extends->where,
                      "one of them must stand on its own");
    return {};
  }
  if (std::error_code error; !std::filesystem::exists(base_path, error)) {
    diagnostics.error("file-missing", "there is no file `" + base_path + "` to extend", extends->where,
                      "the path is relative to the file that names it");
    files.push_back(base_path);
    return {};
  }
  Diagnostics of_base;
  Node base = from_file(base_path, chain, files, of_base);
  diagnostics.append(of_base);
  if (!base.is(Kind::object)) return {};
  return merged(std::move(base), std::move(root));
}

}  // namespace

Loaded load_file(const std::string& path, Diagnostics& diagnostics) {
  Loaded loaded;
  std::vector<Link> chain;
  loaded.root = from_file(path, chain, loaded.files, diagnostics);
  return loaded;
}

Loaded load_text(const std::string& text, const std::string& file, Diagnostics& diagnostics) {
  Loaded loaded;
  loaded.files.push_back(file);
  std::vector<Link> chain;
  loaded.root = with_base(json::parse(text, file, diagnostics), file, chain, loaded.files, diagnostics);
  return loaded;
}

}  // namespace loom::graph
