// Model: which textures and buffers there are, what they mean, and the one that is looked at.
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "interop/grid.h"
#include "interop/probes.h"
#include "viewer/model.h"

namespace loom::viewer {
namespace {

constexpr std::string_view last_frame = "@prev";

/// Quantities that are never below zero. Of all others (harmonics, normals, offsets, what a plugin brings) it is not
/// known.
bool never_negative(std::string_view type, std::string_view member) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 17> quantities = {{
      {"Surface", "depth"},
      {"Surface", "albedo"},
      {"Surface", "emission"},
      {"LightLayers", "flux"},
      {"LightLayers", "depth"},
      {"LightLayers", "shadow"},
      {"GeometryImage", "flux"},
      {"GeometryImage", "albedo"},
      {"VoxelScene", "occupancy"},
      {"VoxelScene", "coverage"},
      {"VoxelScene", "extent"},
      {"VoxelScene", "albedo"},
      {"VoxelScene", "emission"},
      {"VoxelScene", "radiance"},
      {"ProbeField", "moments"},
      {"Irradiance", "irradiance"},
      {"Image", "image"},
  }};
  return std::find(quantities.begin(), quantities.end(), std::pair(type, member)) != quantities.end();
}

struct Found {
  const graph::BoundPort* port = nullptr;
  const graph::BoundMember* member = nullptr;
};

/// A port that carries the resource: its producer's, else (the last frame's) a consumer's.
Found find_port(const graph::CompiledGraph& graph, int resource) {
  Found found;
  for (const graph::CompiledPass& pass : graph.passes)
    for (const graph::BoundPort& port : pass.bound)
      for (const graph::BoundMember& member : port.members) {
        if (member.resource != resource || port.bundle == graph::none) continue;
        if (!port.is_input) return {&port, &member};
        found = {&port, &member};
      }
  return found;
}

template <class T>
std::optional<T> struct_of(std::span<const std::byte> bytes) {
  if (bytes.size() != sizeof(T)) return std::nullopt;
  T data;
  std::memcpy(&data, bytes.data(), sizeof(T));
  return data;
}

CellContent content_of(std::string_view type, std::string_view member) {
  if (type == "ShVolume" || member == "directional") return CellContent::harmonics;
  if (type != "ProbeField") return CellContent::value;
  return member == "coefficients" ? CellContent::coefficients
         : member == "moments"    ? CellContent::moments
                                  : CellContent::state;
}

}  // namespace

std::vector<Inspectable> Model::inspectables() const {
  std::vector<Inspectable> list;
  const graph::CompiledGraph& graph = live_.graph();
  for (const graph::CompiledPass& pass : graph.passes) {
    for (const graph::BoundPort& port : pass.bound) {
      const BundleType* type = registry_->bundle(port.type);
      if (port.is_input || port.absent || type == nullptr) continue;
      for (const BundleMember& member : type->members) {
        const auto bound = std::find_if(port.members.begin(), port.members.end(),
                                        [&](const auto& m) { return m.name == member.name; });
        if (bound == port.members.end()) continue;
        list.push_back({.pass = pass.name,
                        .port = port.name,
                        .member = member.name,
                        .name = pass.name + "." + port.name + "." + member.name,
                        .type = port.type,
                        .unit = member.unit,
                        .buffer = member.kind == MemberKind::buffer,
                        .made = bound->resource != graph::none,
                        .never_negative = never_negative(port.type, member.name)});
      }
    }
  }
  const std::size_t members = list.size();
  for (const graph::Resource& resource : graph.resources) {
    const bool state = resource.lifetime == graph::Resource::Lifetime::persistent || resource.history_of != graph::none;
    if (!state) continue;
    Inspectable item{.pass = resource.name.substr(0, resource.name.find('.')),
                     .member = resource.name.substr(resource.name.rfind('.') + 1),
                     .name = resource.name,
                     .buffer = std::holds_alternative<BufferDesc>(resource.desc),
                     .made = true,
                     .state = true};
    // The last frame's is what this frame's is.
    if (item.name.ends_with(last_frame)) {
      const std::string now = item.name.substr(0, item.name.size() - last_frame.size());
      for (std::size_t i = 0; i < members; ++i)
        if (list[i].name == now) {
          item.type = list[i].type;
          item.unit = list[i].unit;
          item.never_negative = list[i].never_negative;
        }
    }
    list.push_back(std::move(item));
  }
  return list;
}

PipelineRequest Model::request() const {
  const auto set = edits_.set.find(edits_.pipeline);
  PipelineRequest request{
      .path = edits_.pipeline, .set = set == edits_.set.end() ? Settings{} : set->second, .size = size_, .inspect = {}};
  const bool endpoint = !inspected_.empty() && inspected_.find('@') == std::string::npos &&
                        inspected_.find(".persistent.") == std::string::npos;
  if (!endpoint) return request;
  request.inspect.push_back(inspected_);
  if (!inspected_states_.empty()) request.inspect.push_back(inspected_states_);
  return request;
}

bool Model::inspect(const std::string& name) {
  if (name == inspected_) return true;
  const std::string before = std::exchange(inspected_, name), states = std::exchange(inspected_states_, std::string());
  // Probes stand where their states say.
  for (const Inspectable& item : inspectables())
    if (item.name == name)
      for (const Inspectable& other : inspectables())
        if (other.pass == item.pass && other.port == item.port && other.member == "state" && item.member != "state")
          inspected_states_ = other.name;
  const PipelineRequest wanted = request();
  if (wanted.inspect == live_.request().inspect) return true;
  if (live_.compile(wanted, surroundings())) return succeed();
  inspected_ = before;
  inspected_states_ = states;
  return fail(live_.error());
}

int Model::resource_of(const std::string& name) const {
  if (name.empty() || !live_.running()) return graph::none;
  const graph::CompiledGraph& graph = live_.graph();
  for (const graph::GraphOutput& output : graph.outputs)
    if (output.name == name) return output.resource;
  for (std::size_t i = 0; i < graph.resources.size(); ++i)
    if (graph.resources[i].name == name) return static_cast<int>(i);
  return graph::none;
}

const Texture* Model::inspected_texture() const {
  const int resource = resource_of(inspected_);
  return resource == graph::none ? nullptr : live_.renderer().resource(resource);
}

const Buffer* Model::inspected_buffer() const {
  const int resource = resource_of(inspected_);
  return resource == graph::none ? nullptr : live_.renderer().buffer(resource);
}

std::uint64_t Model::inspected_version() const {
  const auto made = made_.find(inspected_.substr(0, inspected_.find('.')));
  const bool state = inspected_.find('@') != std::string::npos || inspected_.find(".persistent.") != std::string::npos;
  return state || made == made_.end() ? frames_ : made->second;
}

bool Model::inspects_volume() const {
  const Texture* texture = inspected_texture();
  if (texture == nullptr) return false;
  const auto [port, member] = find_port(live_.graph(), resource_of(inspected_));
  if (port == nullptr) return false;
  const bool volume = texture->desc().kind == TextureKind::d3;
  return (volume && (port->type == "ShVolume" || port->type == "VoxelScene")) || port->type == "ProbeField";
}

std::optional<VolumeSource> Model::inspected_volume() const {
  if (!inspects_volume()) return std::nullopt;
  const auto [port, member] = find_port(live_.graph(), resource_of(inspected_));
  const std::span<const std::byte> bytes = live_.renderer().bundle_data(port->bundle);
  VolumeSource source{.texels = {}, .grid = {}, .content = content_of(port->type, member->name), .states = {}};
  if (port->type == "ProbeField") {
    const auto grid = struct_of<interop::ProbeGrid>(bytes);
    if (!grid) return std::nullopt;
    source.grid = *grid;
  } else {
    const auto grid = struct_of<interop::Grid>(bytes);
    if (!grid) return std::nullopt;
    source.grid = *grid;
  }
  const Texture& texture = *inspected_texture();
  source.texels = {.desc = texture.desc(), .mip = 0, .box = level_box(texture.desc(), 0), .values = texture.read()};
  source.at_corner = member->name == "directional";
  const auto& attributes = live_.graph().bundles[static_cast<std::size_t>(port->bundle)].attributes;
  const auto basis = attributes.find("basis");
  source.gaussians = basis != attributes.end() && basis->second == Attribute(std::string("sg"));
  if (port->type == "ShVolume") {
    const bool grey = std::none_of(port->members.begin(), port->members.end(), [](const graph::BoundMember& m) {
      return m.name == "green" && m.resource != graph::none;
    });
    const glm::vec3 hues[] = {{1, .35F, .3F}, {.35F, 1, .4F}, {.4F, .55F, 1}};
    if (!grey) source.tint = hues[member->name == "red" ? 0 : member->name == "green" ? 1 : 2];
  }
  const int states = source.content == CellContent::state ? resource_of(inspected_) : resource_of(inspected_states_);
  if (const Texture* offsets = states == graph::none ? nullptr : live_.renderer().resource(states))
    source.states = offsets->read();
  return source;
}

}  // namespace loom::viewer
