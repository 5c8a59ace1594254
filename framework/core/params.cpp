#include "loom/params.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "loom/diagnostic.h"

namespace loom {
namespace {

std::string text_of(double value) {
  std::ostringstream out;
  out.precision(9);
  out << value;
  return out.str();
}

std::string range_of(const ParamDecl& decl) {
  std::string range = text_of(decl.min) + " … " + text_of(decl.max);
  if (!decl.unit.empty()) range += ' ' + decl.unit;
  return range;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "`" : ", `") + name + '`';
  return text;
}

std::string_view expectation(ParamKind kind) {
  switch (kind) {
    case ParamKind::boolean:
      return "true or false";
    case ParamKind::integer:
      return "a whole number";
    case ParamKind::real:
      return "a number";
    case ParamKind::choice:
    case ParamKind::text:
      return "a string";
    case ParamKind::colour:
      break;
  }
  return "an array of three numbers";
}

/// What the value is, shown as it stood where it is short.
std::string shown(const json::Node& value) {
  switch (value.kind) {
    case json::Kind::boolean:
      return value.boolean ? "`true`" : "`false`";
    case json::Kind::integer:
      return '`' + std::to_string(value.integer) + '`';
    case json::Kind::number:
      return '`' + text_of(value.number) + '`';
    case json::Kind::string:
      return "the string \"" + value.string.substr(0, 40) + (value.string.size() > 40 ? "…\"" : "\"");
    case json::Kind::array:
      return "an array of " + std::to_string(value.items.size());
    default:
      return std::string(json::to_string(value.kind));
  }
}

template <class Target, class Options>
ParamDecl declaration(ParamKind kind, std::string name, Target& target, Options options) {
  ParamDecl decl{.kind = kind, .target = &target, .default_value = target};
  decl.name = std::move(name);
  decl.cost = options.cost;
  decl.doc = std::move(options.doc);
  if constexpr (requires { options.scale; }) {
    decl.min = options.min;
    decl.max = options.max;
    decl.unit = std::move(options.unit);
    decl.scale = options.scale;
  }
  return decl;
}

/// A declaration that cannot hold its own default is the pass author's mistake, found at the first use.
void add(std::vector<ParamDecl>& decls, ParamDecl decl) {
  const auto fail = [&](const std::string& why) { throw Error("parameter `" + decl.name + "`: " + why); };
  for (const auto& other : decls)
    if (other.name == decl.name) fail("declared twice");
  const auto inside = [&](float value) {
    // Bounds are written as doubles: 0.1f is not 0.1, but it is meant to lie in a range that starts there.
    if (!(value >= static_cast<float>(decl.min) && value <= static_cast<float>(decl.max)))
      fail("its default " + text_of(value) + " lies outside its range " + range_of(decl));
  };
  if (const auto* whole = std::get_if<int>(&decl.default_value))
    if (*whole < decl.min || *whole > decl.max)
      fail("its default " + std::to_string(*whole) + " lies outside its range " + range_of(decl));
  if (const auto* real = std::get_if<float>(&decl.default_value)) inside(*real);
  if (const auto* colour = std::get_if<glm::vec3>(&decl.default_value))
    for (int i = 0; i < 3; ++i) inside((*colour)[i]);
  if (decl.kind == ParamKind::choice) {
    const auto& name = std::get<std::string>(decl.default_value);
    if (std::find(decl.choices.begin(), decl.choices.end(), name) == decl.choices.end())
      fail("its default \"" + name + "\" is none of its choices");
  }
  decls.push_back(std::move(decl));
}

}  // namespace

void Params::boolean(std::string name, bool& target, BoolOptions options) {
  add(decls_, declaration(ParamKind::boolean, std::move(name), target, std::move(options)));
}

void Params::integer(std::string name, int& target, IntOptions options) {
  add(decls_, declaration(ParamKind::integer, std::move(name), target, std::move(options)));
}

void Params::real(std::string name, float& target, RealOptions options) {
  add(decls_, declaration(ParamKind::real, std::move(name), target, std::move(options)));
}

void Params::choice(std::string name, std::string& target, std::vector<std::string> choices, TextOptions options) {
  ParamDecl decl = declaration(ParamKind::choice, std::move(name), target, std::move(options));
  decl.choices = std::move(choices);
  add(decls_, std::move(decl));
}

void Params::text(std::string name, std::string& target, TextOptions options) {
  add(decls_, declaration(ParamKind::text, std::move(name), target, std::move(options)));
}

void Params::colour(std::string name, glm::vec3& target, RealOptions options) {
  add(decls_, declaration(ParamKind::colour, std::move(name), target, std::move(options)));
}

const ParamDecl* Params::find(std::string_view name) const {
  const auto it = std::find_if(decls_.begin(), decls_.end(), [&](const auto& d) { return d.name == name; });
  return it == decls_.end() ? nullptr : &*it;
}

bool Params::set(std::string_view name, const json::Node& value, std::string_view owner, Diagnostics& diagnostics) {
  const ParamDecl* decl = find(name);
  std::string path(owner);
  path += '.';
  path += name;
  if (decl == nullptr) {
    std::vector<std::string> names;
    for (const auto& candidate : decls_) names.push_back(candidate.name);
    const std::string near = nearest_name(name, names);
    std::string hint = names.empty()  ? "it has no parameters"
                       : near.empty() ? "it has " + joined(names)
                                      : "did you mean `" + near + "`?";
    diagnostics.error("unknown-param", "`" + std::string(owner) + "` has no parameter `" + std::string(name) + '`',
                      value.where, std::move(hint));
    return false;
  }
  const auto wrong_type = [&] {
    diagnostics.error("param-type",
                      "`" + path + "` takes " + std::string(expectation(decl->kind)) + ", but this is " + shown(value),
                      value.where, decl->kind == ParamKind::choice ? "one of " + joined(decl->choices) : std::string());
    return false;
  };
  const auto in_range = [&](double number) {
    if (number >= decl->min && number <= decl->max) return true;
    diagnostics.error("param-range", "`" + path + "` = " + text_of(number) + " is outside " + range_of(*decl),
                      value.where);
    return false;
  };
  switch (decl->kind) {
    case ParamKind::boolean:
      if (!value.is(json::Kind::boolean)) return wrong_type();
      *std::get<bool*>(decl->target) = value.boolean;
      return true;
    case ParamKind::integer:
      if (!value.is(json::Kind::integer)) return wrong_type();
      if (!in_range(value.number)) return false;
      *std::get<int*>(decl->target) = static_cast<int>(value.integer);
      return true;
    case ParamKind::real:
      if (!value.is_number()) return wrong_type();
      if (!in_range(value.number)) return false;
      *std::get<float*>(decl->target) = static_cast<float>(value.number);
      return true;
    case ParamKind::choice:
      if (!value.is(json::Kind::string)) return wrong_type();
      if (std::find(decl->choices.begin(), decl->choices.end(), value.string) == decl->choices.end()) {
        const std::string near = nearest_name(value.string, decl->choices);
        diagnostics.error("param-choice", "`" + path + "` cannot be \"" + value.string + "\"", value.where,
                          near.empty() ? "one of " + joined(decl->choices) : "did you mean `" + near + "`?");
        return false;
      }
      *std::get<std::string*>(decl->target) = value.string;
      return true;
    case ParamKind::text:
      if (!value.is(json::Kind::string)) return wrong_type();
      *std::get<std::string*>(decl->target) = value.string;
      return true;
    case ParamKind::colour:
      break;
  }
  if (!value.is(json::Kind::array) || value.items.size() != 3 ||
      !std::all_of(value.items.begin(), value.items.end(), [](const auto& item) { return item.is_number(); }))
    return wrong_type();
  if (!std::all_of(value.items.begin(), value.items.end(), [&](const auto& item) { return in_range(item.number); }))
    return false;
  *std::get<glm::vec3*>(decl->target) = glm::vec3(value.items[0].number, value.items[1].number, value.items[2].number);
  return true;
}

bool Params::set_text(std::string_view name, std::string_view text, std::string_view owner, Diagnostics& diagnostics) {
  const ParamDecl* decl = find(name);
  const std::string source = "--set " + std::string(owner) + '.' + std::string(name) + '=' + std::string(text);
  const bool wants_string = decl != nullptr && (decl->kind == ParamKind::choice || decl->kind == ParamKind::text);
  json::Node value;
  Diagnostics ignored;
  // For a string, `16` and `true` are text unless they are quoted.
  if (!wants_string || text.starts_with('"')) value = json::parse(text, source, ignored);
  if (!ignored.all().empty() && ignored.all().front().code == "not-finite") {
    diagnostics.error("not-finite", ignored.all().front().message, {source, 0, 0, {}});
    return false;
  }
  if (wants_string ? !value.is(json::Kind::string) : ignored.has_errors()) {
    value = {};
    value.kind = json::Kind::string;
    value.string = std::string(text);
    // `.5` and `2.` are numbers to everybody but JSON.
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (!wants_string && error == std::errc{} && end == text.data() + text.size() && std::isfinite(number)) {
      value.kind = json::Kind::number;
      value.number = number;
    }
  }
  const auto place = [&](auto&& self, json::Node& node) -> void {
    node.where = {source, 0, 0, {}};  // a column inside an argument says nothing
    for (auto& item : node.items) self(self, item);
  };
  place(place, value);
  return set(name, value, owner, diagnostics);
}

ParamValue Params::value_of(const ParamDecl& decl) {
  return std::visit([](const auto* target) -> ParamValue { return *target; }, decl.target);
}

}  // namespace loom
