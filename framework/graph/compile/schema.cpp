// The JSON Schema of pipeline files: what an editor needs to complete and check one.
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "graph/compile/document.h"
#include "graph/compile/export.h"
#include "loom/pass.h"

namespace loom::graph {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* name_pattern = "^[a-z0-9_]+$";
constexpr const char* wire_pattern = "^([a-z0-9_]+\\.[a-z0-9_]+(@prev)?)$";
constexpr const char* output_pattern = "^[a-z0-9_]+\\.[a-z0-9_]+(\\.[a-z0-9_]+)?$";

/// The double that prints as the float does: 0.1f as 0.1, not as 0.10000000149011612.
double as_written(float value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  double result = value;
  std::from_chars(text.data(), written.ptr, result);
  return result;
}

Json default_of(const ParamDecl& decl) {
  struct Visitor {
    Json operator()(bool value) const { return value; }
    Json operator()(int value) const { return value; }
    Json operator()(float value) const { return as_written(value); }
    Json operator()(const std::string& value) const { return value; }
    Json operator()(const glm::vec3& v) const { return {as_written(v.x), as_written(v.y), as_written(v.z)}; }
  };
  return std::visit(Visitor{}, decl.default_value);
}

/// null is allowed everywhere: in a file that extends another it takes the value back to the default.
Json schema_of(const ParamDecl& decl) {
  Json schema;
  switch (decl.kind) {
    case ParamKind::boolean:
      schema["type"] = {"boolean", "null"};
      break;
    case ParamKind::integer:
      schema["type"] = {"integer", "null"};
      break;
    case ParamKind::real:
      schema["type"] = {"number", "null"};
      break;
    case ParamKind::text:
      schema["type"] = {"string", "null"};
      break;
    case ParamKind::choice:
      schema["enum"] = decl.choices;
      schema["enum"].push_back(nullptr);
      break;
    case ParamKind::colour:
      schema["type"] = {"array", "null"};
      schema["items"] = {{"type", "number"}, {"minimum", decl.min}, {"maximum", decl.max}};
      schema["minItems"] = 3;
      schema["maxItems"] = 3;
      break;
  }
  if (decl.kind == ParamKind::integer || decl.kind == ParamKind::real) {
    schema["minimum"] = decl.min;
    schema["maximum"] = decl.max;
    if (decl.kind == ParamKind::integer) {
      schema["minimum"] = static_cast<std::int64_t>(decl.min);
      schema["maximum"] = static_cast<std::int64_t>(decl.max);
    }
  }
  schema["default"] = default_of(decl);
  std::string doc = decl.doc;
  if (!decl.unit.empty()) doc += (doc.empty() ? "[" : " [") + decl.unit + ']';
  if (!doc.empty()) schema["description"] = doc;
  return schema;
}

/// What a type declares when nothing is wired and the scene is empty.
struct Probe {
  std::unique_ptr<Pass> pass;  ///< what the declarations point into
  Params params;
  std::optional<std::vector<InputDecl>> inputs;  ///< empty: they depend on the pass's own keys
  std::vector<std::string> keys;
};

std::optional<Probe> probe(const PassType& type) {
  try {
    Probe probe;
    probe.pass = type.create();
    if (probe.pass == nullptr) return std::nullopt;
    for (const auto key : probe.pass->own_keys()) probe.keys.emplace_back(key);
    probe.pass->params(probe.params);
    if (probe.keys.empty()) {
      Ports ports({1, 1}, {});
      probe.pass->reflect(ports, SceneFacts{});
      probe.inputs = std::move(ports.inputs);
    }
    return probe;
  } catch (const std::exception&) {
    return std::nullopt;  // it says so itself as soon as a pipeline uses it
  }
}

Json wire_schema(const std::string& doc) {
  Json schema = {{"type", {"string", "null"}}, {"pattern", wire_pattern}};
  if (!doc.empty()) schema["description"] = doc;
  return schema;
}

Json inputs_schema(const std::optional<std::vector<InputDecl>>& inputs) {
  Json schema = {{"type", {"object", "null"}}};
  if (!inputs) {
    schema["additionalProperties"] = wire_schema({});
    return schema;
  }
  schema["properties"] = Json::object();
  for (const auto& input : *inputs)
    schema["properties"][input.name] =
        wire_schema((input.type == "*" ? "any bundle" : input.type) + (input.optional ? ", optional" : ""));
  schema["additionalProperties"] = false;
  return schema;
}

Json params_schema(const Probe& probe) {
  Json schema = {{"type", {"object", "null"}}, {"properties", Json::object()}};
  for (const auto& decl : probe.params.all()) schema["properties"][decl.name] = schema_of(decl);
  // The parameters of a pass with keys of its own may be declared by these.
  schema["additionalProperties"] = !probe.keys.empty();
  return schema;
}

/// if the type is this one, then its inputs, parameters and keys are these.
Json type_schema(const PassType& type) {
  Json condition = {{"properties", {{"type", {{"const", type.name}}}}}, {"required", {"type"}}};
  Json consequence = Json::object();
  if (!type.summary.empty()) consequence["description"] = type.summary;
  if (const auto probed = probe(type)) {
    consequence["properties"] = {{"in", inputs_schema(probed->inputs)}, {"params", params_schema(*probed)}};
    std::vector<std::string> keys(std::begin(pass_keys), std::end(pass_keys));
    keys.insert(keys.end(), probed->keys.begin(), probed->keys.end());
    consequence["propertyNames"] = {{"enum", keys}};
  }
  return {{"if", std::move(condition)}, {"then", std::move(consequence)}};
}

Json pass_schema(const Registry& registry) {
  Json names = Json::array();
  Json types = Json::array();
  for (const auto& type : registry.passes()) {
    names.push_back(type.name);
    types.push_back(type_schema(type));
  }
  Json schema = {{"type", {"object", "null"}},
                 {"properties",
                  {{"type", {{"type", "string"}, {"enum", names}}},
                   {"in", {{"type", {"object", "null"}}}},
                   {"params", {{"type", {"object", "null"}}}},
                   {"summary", {{"type", {"string", "null"}}}}}}};
  if (!types.empty()) schema["allOf"] = std::move(types);
  return schema;
}

Json input_schema(const Registry& registry) {
  Json bundles = Json::array();
  for (const auto& bundle : registry.bundles()) bundles.push_back(bundle.name);
  Json formats = Json::array();
  for (int i = 0; i <= static_cast<int>(Format::depth32f); ++i) formats.push_back(to_string(static_cast<Format>(i)));
  return {{"type", {"object", "null"}},
          {"description", "a bundle that the embedding program supplies"},
          {"properties",
           {{"type", {{"enum", bundles}}},
            {"format", {{"enum", formats}, {"description", "of the first member"}}},
            {"size",
             {{"anyOf",
               {{{"const", "frame"}},
                {{"type", "array"},
                 {"items", {{"type", "integer"}, {"minimum", 1}, {"maximum", 16384}}},
                 {"minItems", 2},
                 {"maxItems", 2}}}}}},
            {"summary", {{"type", "string"}}}}},
          {"required", {"type"}},
          {"additionalProperties", false}};
}

Json named(Json schema) {
  return {{"type", {"object", "null"}},
          {"propertyNames", {{"pattern", name_pattern}}},
          {"additionalProperties", std::move(schema)}};
}

}  // namespace

std::string pipeline_schema(const Registry& registry) {
  Json output = {{"type", {"string", "null"}},
                 {"pattern", output_pattern},
                 {"description", "pass.port or pass.port.member; null: the pipeline makes none"}};
  Json outputs = named(std::move(output));
  outputs["properties"] = {{"image", {{"description", "what is shown"}}},
                           {"hdr", {{"description", "radiance, W/(m² sr)"}}},
                           {"indirect", {{"description", "irradiance by emitters and bounces, W/m²"}}},
                           {"bounce", {{"description", "irradiance after at least one reflection, W/m²"}}}};
  for (auto& known : outputs["properties"]) {
    known["type"] = {"string", "null"};
    known["pattern"] = output_pattern;
  }
  const Json schema = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Lightloom pipeline"},
      {"type", "object"},
      {"properties",
       {{"$schema", {{"type", "string"}}},
        {"name", {{"type", "string"}}},
        {"summary", {{"type", "string"}}},
        {"measured", {{"type", "object"}, {"description", "what loom tune found of this pipeline; nothing reads it"}}},
        {"extends", {{"type", "string"}, {"description", "the pipeline this one varies; relative to this file"}}},
        {"inputs", named(input_schema(registry))},
        {"passes", named({{"$ref", "#/definitions/pass"}})},
        {"outputs", std::move(outputs)}}},
      {"anyOf", {{{"required", {"extends"}}}, {{"required", {"passes", "outputs"}}}}},
      {"additionalProperties", false},
      {"definitions", {{"pass", pass_schema(registry)}}}};
  return schema.dump(2) + '\n';
}

}  // namespace loom::graph
