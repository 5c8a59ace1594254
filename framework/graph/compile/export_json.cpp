// The graph and the plan as JSON.
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "graph/compile/export.h"

namespace loom::graph {
namespace {

using Json = nlohmann::ordered_json;

constexpr int version = 1;

std::string_view name_of(Resource::Lifetime lifetime) {
  constexpr std::array<std::string_view, 6> names = {"transient",  "output", "history",
                                                     "persistent", "kept",   "external"};
  return names.at(static_cast<std::size_t>(lifetime));
}

Json optional_text(const std::optional<std::string>& text) { return text ? Json(*text) : Json(nullptr); }

Json value_of(const Attribute& attribute) {
  return std::visit([](const auto& value) { return Json(value); }, attribute);
}

/// "rgba16f" and "512x512", or "buffer" and "1024".
std::pair<std::string, std::string> format_and_size(const std::variant<TextureDesc, BufferDesc>& desc) {
  if (const auto* buffer = std::get_if<BufferDesc>(&desc)) return {"buffer", std::to_string(buffer->bytes)};
  const std::string text = to_string(std::get<TextureDesc>(desc));
  const auto blank = text.find(' ');
  return {text.substr(0, blank), text.substr(blank + 1)};
}

Json barriers_of(unsigned bits) {
  constexpr std::array<std::pair<unsigned, const char*>, 5> names = {{{barrier_texture_fetch, "texture-fetch"},
                                                                      {barrier_image_access, "image-access"},
                                                                      {barrier_storage, "storage"},
                                                                      {barrier_framebuffer, "framebuffer"},
                                                                      {barrier_update, "update"}}};
  Json list = Json::array();
  for (const auto& [bit, name] : names)
    if ((bits & bit) != 0) list.push_back(name);
  return list;
}

Json pruned_of(const CompiledGraph& graph) {
  Json list = Json::array();
  for (const auto& [what, why] : graph.pruned) list.push_back({{"what", what}, {"why", why}});
  return list;
}

Json resource_of(const Resource& resource) {
  const auto [format, size] = format_and_size(resource.desc);
  return {{"name", resource.name},
          {"format", format},
          {"size", size},
          {"bytes", resource.bytes},
          {"first", resource.first},
          {"last", resource.last},
          {"slot", resource.slot},
          {"lifetime", name_of(resource.lifetime)}};
}

Json facts_of(const SceneFacts& facts) {
  const auto vec = [](const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); };
  return {{"spot_lights", facts.spot_lights},
          {"wide_spot_lights", facts.wide_spot_lights},
          {"point_lights", facts.point_lights},
          {"directional_lights", facts.directional_lights},
          {"light_faces", facts.light_faces()},
          {"sky", facts.sky},
          {"sky_image", facts.sky_image},
          {"sky_bands", facts.sky_bands},
          {"emissive_triangles", facts.emissive_triangles},
          {"emissive_textures", facts.emissive_textures},
          {"emissive_area_m2", facts.emissive_area},
          {"emitted_power_w", facts.emitted_power},
          {"alpha_mask", facts.alpha_mask},
          {"normal_maps", facts.normal_maps},
          {"textures", facts.textures},
          {"moves", facts.moves},
          {"geometry_moves", facts.geometry_moves},
          {"lights_move", facts.lights_move},
          {"camera_moves", facts.camera_moves},
          {"measured", facts.measured.has_value()},
          {"max_chroma", facts.max_chroma},
          {"max_albedo", facts.max_albedo},
          {"thinnest_feature", facts.thinnest_feature},
          {"bounds_min", vec(facts.bounds_min)},
          {"bounds_max", vec(facts.bounds_max)},
          {"triangles", facts.triangles},
          {"moving_triangles", facts.moving_triangles},
          {"content_hash", fmt::format("{:016x}", facts.content_hash)}};
}

Json port_of(const CompiledGraph& graph, const BoundPort& port) {
  Json members = Json::array();
  for (const auto& member : port.members)
    members.push_back({{"name", member.name},
                       {"access", to_string(member.access)},
                       {"declared", member.declared},
                       {"resource", member.resource == none
                                        ? Json(nullptr)
                                        : Json(graph.resources[static_cast<std::size_t>(member.resource)].name)}});
  Json json = {{"name", port.name}, {"type", port.type}, {"connected", port.connected}, {"history", port.history}};
  json["absent"] = optional_text(port.absent);
  if (port.bundle != none) {
    json["attributes"] = Json::object();
    for (const auto& [name, value] : graph.bundles[static_cast<std::size_t>(port.bundle)].attributes)
      json["attributes"][name] = value_of(value);
  }
  json["members"] = std::move(members);
  return json;
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n'; }

}  // namespace

std::string to_json(const CompiledGraph& graph) {
  Json passes = Json::array();
  for (const auto& pass : graph.passes) {
    Json inputs = Json::array();
    Json outputs = Json::array();
    Json state = Json::array();
    for (const auto& port : pass.bound) {
      const bool is_state = port.type.empty() && (port.name == "scratch" || port.name == "persistent");
      (is_state ? state : port.is_input ? inputs : outputs).push_back(port_of(graph, port));
    }
    passes.push_back({{"name", pass.name},
                      {"type", pass.type},
                      {"runs", pass.runs},
                      {"inputs", std::move(inputs)},
                      {"outputs", std::move(outputs)},
                      {"state", std::move(state)}});
  }
  Json wires = Json::array();
  for (const auto& edge : graph.edges)
    wires.push_back({{"from", edge.from_pass + '.' + edge.from_port},
                     {"to", edge.to_pass + '.' + edge.to_port},
                     {"type", edge.type},
                     {"history", edge.history}});
  Json outputs = Json::array();
  for (const auto& output : graph.outputs)
    outputs.push_back({{"name", output.name},
                       {"endpoint", output.endpoint},
                       {"quantity", output.quantity},
                       {"absent", optional_text(output.absent)}});
  return text_of({{"version", version},
                  {"name", graph.name},
                  {"summary", graph.summary},
                  {"file", graph.file},
                  {"passes", std::move(passes)},
                  {"wires", std::move(wires)},
                  {"outputs", std::move(outputs)},
                  {"pruned", pruned_of(graph)}});
}

std::string plan_json(const CompiledGraph& graph, const SceneFacts& facts) {
  Json passes = Json::array();
  for (const int index : graph.order) {
    const CompiledPass& pass = graph.passes[static_cast<std::size_t>(index)];
    passes.push_back({{"name", pass.name}, {"type", pass.type}, {"barriers", barriers_of(pass.barriers)}});
  }
  Json resources = Json::array();
  for (const auto& resource : graph.resources) resources.push_back(resource_of(resource));
  Json decisions = Json::array();
  for (const auto& decision : graph.decisions)
    decisions.push_back(
        {{"rule", decision.rule},
         {"decision", decision.pass.empty() ? decision.decision : decision.pass + ": " + decision.decision},
         {"evidence", decision.evidence}});
  return text_of(
      {{"version", version},
       {"name", graph.name},
       {"file", graph.file},
       {"passes", std::move(passes)},
       {"resources", std::move(resources)},
       {"facts", facts_of(facts)},
       {"decisions", std::move(decisions)},
       {"pruned", pruned_of(graph)},
       {"memory", {{"textures_bytes", graph.bytes}, {"without_aliasing_bytes", graph.bytes_without_aliasing}}}});
}

}  // namespace loom::graph
