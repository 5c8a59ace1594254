// loom passes: every pass type there is, with its ports and parameters.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "cli/commands.h"
#include "cli/json_out.h"
#include "graph/compile/export.h"
#include "loom/facts.h"
#include "loom/params.h"
#include "loom/pass.h"
#include "loom/ports.h"

namespace loom::cli {
namespace {

/// One of everything, so that no port is left out for want of a light.
SceneFacts rich_facts() {
  SceneFacts facts;
  facts.spot_lights = 1;
  facts.point_lights = 1;
  facts.directional_lights = 1;
  facts.sky = true;
  facts.emissive_triangles = 2;
  facts.alpha_mask = true;
  facts.normal_maps = true;
  facts.textures = true;
  facts.moves = true;
  facts.max_chroma = 1;
  facts.max_albedo = .8;
  facts.thinnest_feature = .1;
  facts.bounds_min = glm::dvec3(-1);
  facts.bounds_max = glm::dvec3(1);
  facts.triangles = 100;
  return facts;
}

/// A pass as it describes itself with nothing wired. Ports may depend on the wiring; what it declares so is shown.
struct Description {
  std::unique_ptr<Pass> pass;
  Params params;
  Ports ports{{512, 512}, {}};
};

Description describe(const PassType& type) {
  Description description;
  description.pass = type.create();
  description.pass->params(description.params);
  try {
    description.pass->reflect(description.ports, rich_facts());
  } catch (const std::exception&) {
    // With nothing wired some passes cannot go on; what they had declared until then is what there is to show.
  }
  return description;
}

const char* name_of(ParamKind kind) {
  switch (kind) {
    case ParamKind::boolean:
      return "boolean";
    case ParamKind::integer:
      return "integer";
    case ParamKind::real:
      return "real";
    case ParamKind::choice:
      return "choice";
    case ParamKind::text:
      return "text";
    case ParamKind::colour:
      break;
  }
  return "colour";
}

const char* name_of(Cost cost) {
  switch (cost) {
    case Cost::live:
      return "live";
    case Cost::shader:
      return "shader";
    case Cost::graph:
      break;
  }
  return "graph";
}

/// A bound of the parameter; whole numbers stay whole.
Json bound_json(const ParamDecl& param, double bound) {
  if (param.kind == ParamKind::integer) return static_cast<std::int64_t>(bound);
  return bound;
}

Json value_json(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, glm::vec3>) {
          return {v.x, v.y, v.z};
        } else {
          return v;
        }
      },
      value);
}

bool has_range(const ParamDecl& param) {
  return param.kind == ParamKind::integer || param.kind == ParamKind::real || param.kind == ParamKind::colour;
}

Json type_json(const PassType& type) {
  const Description description = describe(type);
  Json in = Json::array();
  for (const InputDecl& input : description.ports.inputs) {
    Json reads = Json::array();
    for (const ReadDecl& read : input.reads) reads.push_back(read.member);
    in.push_back({{"name", input.name}, {"type", input.type}, {"optional", input.optional}, {"reads", reads}});
  }
  Json out = Json::array();
  for (const OutputDecl& output : description.ports.outputs) {
    out.push_back({{"name", output.name}, {"type", output.type}});
  }
  Json params = Json::array();
  for (const ParamDecl& param : description.params.all()) {
    Json entry = {{"name", param.name}, {"kind", name_of(param.kind)}, {"default", value_json(param.default_value)}};
    if (has_range(param)) {
      entry["min"] = bound_json(param, param.min);
      entry["max"] = bound_json(param, param.max);
    }
    if (param.kind == ParamKind::choice) entry["choices"] = param.choices;
    entry["unit"] = param.unit;
    entry["scale"] = param.scale == Scale::log ? "log" : "linear";
    entry["cost"] = name_of(param.cost);
    entry["doc"] = param.doc;
    params.push_back(std::move(entry));
  }
  return {{"type", type.name}, {"summary", type.summary}, {"plugin", type.plugin}, {"in", in},
          {"out", out},        {"params", params}};
}

void print_type(const PassType& type) {
  const Description description = describe(type);
  std::printf("%s: %s\n", type.name.c_str(), type.summary.c_str());
  for (const InputDecl& input : description.ports.inputs) {
    std::printf("  in   %-14s %s%s\n", input.name.c_str(), input.type.c_str(), input.optional ? " (optional)" : "");
  }
  for (const OutputDecl& output : description.ports.outputs) {
    std::printf("  out  %-14s %s\n", output.name.c_str(), output.type.c_str());
  }
  for (const ParamDecl& param : description.params.all()) {
    std::string line = value_json(param.default_value).dump();
    if (has_range(param))
      line += "  [" + bound_json(param, param.min).dump() + ", " + bound_json(param, param.max).dump() + "]";
    if (!param.unit.empty()) line += " " + param.unit;
    if (param.kind == ParamKind::choice) line += "  {" + joined(param.choices) + "}";
    std::printf("  set  %-14s %-26s %s\n", param.name.c_str(), line.c_str(), param.doc.c_str());
  }
}

struct Arguments {
  std::string type;
  bool schema = false;
};

void run(const Arguments& arguments, Session& session) {
  Diagnostics refused;
  const Registry registry = load_registry(session, &refused);
  // Printing what there is was the work: a plugin that is missing from it is a failure of it.
  if (refused.has_errors()) session.exit_code = 1;
  if (arguments.schema) {
    const std::string text = graph::pipeline_schema(registry);
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  std::vector<const PassType*> shown;
  for (const PassType& type : registry.passes()) {
    if (arguments.type.empty() || type.name == arguments.type) shown.push_back(&type);
  }
  if (shown.empty() && !arguments.type.empty()) {
    std::vector<std::string> names;
    for (const PassType& type : registry.passes()) names.push_back(type.name);
    const std::string near = nearest_name(arguments.type, names);
    throw bad_input("unknown-type", "no pass type " + arguments.type,
                    (near.empty() ? "" : "did you mean " + near + "? ") + "there are: " + joined(names));
  }
  if (session.json) {
    Json document = versioned();
    Json& list = document["passes"] = Json::array();
    for (const PassType* type : shown) list.push_back(type_json(*type));
    document["diagnostics"] = to_json(refused);
    print(document);
  } else if (!arguments.type.empty()) {
    print_type(*shown.front());
  } else {
    for (const PassType* type : shown) std::printf("%-16s %s\n", type->name.c_str(), type->summary.c_str());
  }
}

}  // namespace

void add_passes(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("passes", "List the pass types, or describe one: ports and parameters");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("type", arguments->type, "Describe this one");
  auto* schema =
      command->add_flag("--schema", arguments->schema, "Write the JSON Schema of pipeline files, for editors");
  add_json_option(*command, session);
  schema->excludes("--json")->excludes("type");
  add_plugin_option(*command, session);
  command->callback([arguments, &session] { run(*arguments, session); });
}

}  // namespace loom::cli
