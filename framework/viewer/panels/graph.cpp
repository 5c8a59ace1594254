// The pipeline as a drawing: what each pass costs, what each wire carries, what was left out and why.
#include "viewer/panels/graph.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

// Sizes in units of the layout; a font size is 14 of them at zoom 1.
constexpr glm::vec2 node_size{128, 58};
constexpr glm::vec2 output_size{70, 24};
constexpr float font_units = 14;
constexpr float grab = 7;  ///< pixels around a wire that count as on it

ImU32 packed(const ImVec4& c, float alpha = 1) { return ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, alpha}); }

std::string mebibytes(std::size_t bytes) {
  return bytes >= (1u << 20) ? fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20))
                             : fmt::format("{:.0f} KiB", std::ceil(static_cast<double>(bytes) / 1024));
}

std::string why_idle(const graph::CompiledGraph& graph, const std::string& what) {
  for (const graph::Pruned& pruned : graph.pruned)
    if (pruned.what == what) return pruned.why;
  return {};
}

/// Bytes of what the pass makes: outputs, scratch and state.
std::size_t bytes_of(const graph::CompiledGraph& graph, const std::string& pass) {
  std::size_t bytes = 0;
  for (const graph::Resource& resource : graph.resources)
    if (resource.name.starts_with(pass + ".")) bytes += resource.bytes;
  return bytes;
}

const graph::PassTimes* times_of(const std::vector<graph::PassTimes>& times, const std::string& pass) {
  for (const graph::PassTimes& t : times)
    if (t.name == pass) return &t;
  return nullptr;
}

/// What a wire carries, one member a line.
std::string wire_text(const graph::CompiledGraph& graph, const graph::Edge& edge) {
  std::string text = fmt::format("{}.{} → {}.{}\n{}{}", edge.from_pass, edge.from_port, edge.to_pass, edge.to_port,
                                 edge.type, edge.history ? ", of the last frame" : "");
  const graph::CompiledPass* pass = graph.pass(edge.from_pass);
  if (pass == nullptr) return text;
  for (const graph::BoundPort& port : pass->bound) {
    if (port.is_input || port.name != edge.from_port) continue;
    if (port.absent) return text + "\ncarries nothing: " + *port.absent;
    for (const graph::BoundMember& member : port.members) {
      if (member.resource == graph::none) {
        const std::string why = why_idle(graph, edge.from_pass + "." + edge.from_port + "." + member.name);
        text += fmt::format("\n  {}: not made{}", member.name, why.empty() ? "" : ", " + why);
        continue;
      }
      const graph::Resource& resource = graph.resources[static_cast<std::size_t>(member.resource)];
      const auto* texture = std::get_if<TextureDesc>(&resource.desc);
      text += fmt::format("\n  {}: {}, {}", member.name, texture != nullptr ? to_string(*texture) : "buffer",
                          mebibytes(resource.bytes));
    }
  }
  return text;
}

float distance_to(const std::vector<ImVec2>& curve, ImVec2 mouse) {
  float nearest = 1e9F;
  for (std::size_t i = 0; i + 3 < curve.size(); i += 3)
    for (int k = 0; k <= 16; ++k) {
      const float t = static_cast<float>(k) / 16, s = 1 - t;
      const float a = s * s * s, b = 3 * s * s * t, c = 3 * s * t * t, d = t * t * t;
      const float x = a * curve[i].x + b * curve[i + 1].x + c * curve[i + 2].x + d * curve[i + 3].x - mouse.x;
      const float y = a * curve[i].y + b * curve[i + 1].y + c * curve[i + 2].y + d * curve[i + 3].y - mouse.y;
      nearest = std::min(nearest, std::hypot(x, y));
    }
  return nearest;
}

/// The first texture behind a wire, for the inspector.
std::string first_member(const Model& model, const std::string& pass, const std::string& port) {
  for (const Inspectable& item : model.inspectables())
    if (item.pass == pass && item.port == port && item.made) return item.name;
  return {};
}

}  // namespace

void GraphPanel::follow(const graph::CompiledGraph& graph, ImVec2 room) {
  // The plan may change with a parameter, the drawing only with what is wired.
  std::string key = graph.file;
  for (const graph::CompiledPass& pass : graph.passes) key += '\n' + pass.name;
  for (const graph::Edge& edge : graph.edges)
    key += '\n' + edge.from_pass + '.' + edge.from_port + '>' + edge.to_pass + '.' + edge.to_port;
  for (const graph::GraphOutput& output : graph.outputs) key += '\n' + output.name + '=' + output.endpoint;
  if (key == key_) return;
  key_ = key;
  try {
    layout_ = lay_out(graph, node_size, output_size);
    failure_.clear();
  } catch (const Error& error) {
    layout_ = {};
    failure_ = error.what();
  }
  const float fit =
      std::min((room.x - 20) / std::max(layout_.size.x, 1.F), (room.y - 20) / std::max(layout_.size.y, 1.F));
  zoom_ = std::clamp(fit, .2F, 1.5F);
  shift_ = .5F * (glm::vec2(room.x, room.y) - zoom_ * layout_.size);
}

ImVec2 GraphPanel::at(glm::vec2 p) const {
  const glm::vec2 screen = corner_ + shift_ + zoom_ * p;
  return {screen.x, screen.y};
}

glm::vec2 GraphPanel::place_of(const std::string& pass) const {
  for (const NodePlace& node : layout_.nodes)
    if (node.pass == pass) return corner_ + shift_ + zoom_ * node.centre;
  return {-1, -1};
}

void GraphPanel::draw(Ui& ui) {
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.x < 20 || room.y < 20) return;
  const graph::CompiledGraph& graph = ui.model.live().graph();
  follow(graph, room);
  if (!failure_.empty()) ImGui::TextColored(colour::error, "no layout: %s", failure_.c_str());
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  corner_ = {corner.x, corner.y};
  ImGui::InvisibleButton(
      "graph", room,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  const ImGuiIO& io = ImGui::GetIO();
  const bool hovered = ImGui::IsItemHovered();
  if (ImGui::IsItemActive()) shift_ += glm::vec2(io.MouseDelta.x, io.MouseDelta.y);
  if (hovered && io.MouseWheel != 0) {
    const float factor = std::pow(1.15F, io.MouseWheel);
    const float zoom = std::clamp(zoom_ * factor, .1F, 4.F);
    const glm::vec2 pointer(io.MousePos.x - corner.x, io.MousePos.y - corner.y);
    shift_ = pointer + (shift_ - pointer) * (zoom / zoom_);
    zoom_ = zoom;
  }
  const bool clicked = hovered && ImGui::IsMouseReleased(ImGuiMouseButton_Left) && io.MouseDragMaxDistanceSqr[0] < 16;
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->PushClipRect(corner, {corner.x + room.x, corner.y + room.y}, true);
  draw_wires(ui, hovered, clicked);
  draw_nodes(ui, hovered, clicked);
  list->PopClipRect();
}

void GraphPanel::draw_wires(Ui& ui, bool hovered, bool clicked) {
  const graph::CompiledGraph& graph = ui.model.live().graph();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float font = zoom_ * font_units * .72F * ImGui::GetFontSize() / font_units;
  for (const WirePlace& wire : layout_.wires) {
    std::vector<ImVec2> curve;
    for (const glm::vec2& p : wire.points) curve.push_back(at(p));
    if (curve.size() < 4) continue;
    const graph::Edge* edge = wire.edge < 0 ? nullptr : &graph.edges[static_cast<std::size_t>(wire.edge)];
    const bool over = hovered && edge != nullptr && distance_to(curve, ImGui::GetIO().MousePos) < grab && !over_node_;
    const graph::CompiledPass* to = edge == nullptr ? nullptr : graph.pass(edge->to_pass);
    const bool idle = to != nullptr && !to->runs;
    const ImU32 tone = over ? packed(colour::accent) : packed(colour::dim, idle ? .3F : .75F);
    for (std::size_t i = 0; i + 3 < curve.size(); i += 3)
      list->AddBezierCubic(curve[i], curve[i + 1], curve[i + 2], curve[i + 3], tone,
                           over                               ? 3.F
                           : edge != nullptr && edge->history ? 1.F
                                                              : 1.6F);
    list->AddCircleFilled(curve.back(), 2.5F * std::max(zoom_, .6F), tone);
    if (edge == nullptr) continue;
    if (font > 7) {
      const ImVec2 middle = curve[curve.size() / 2 / 3 * 3];
      const std::string label = edge->type + (edge->history ? " @prev" : "");
      const ImVec2 size = ImGui::GetFont()->CalcTextSizeA(font, 1e9F, 0, label.c_str());
      list->AddText(ImGui::GetFont(), font, {middle.x - .5F * size.x, middle.y - size.y},
                    packed(colour::dim, idle ? .4F : 1), label.c_str());
    }
    if (!over) continue;
    ImGui::SetTooltip("%s\n\nclick to look at it", wire_text(graph, *edge).c_str());
    if (!clicked) continue;
    std::string name = first_member(ui.model, edge->from_pass, edge->from_port);
    if (!name.empty()) {
      ui.later([&ui, name] { ui.model.inspect(name); });
      ui.open_tab(Tab::texture);
    }
  }
}

void GraphPanel::draw_nodes(Ui& ui, bool hovered, bool clicked) {
  const graph::CompiledGraph& graph = ui.model.live().graph();
  const std::vector<graph::PassTimes>& times = ui.model.pass_times();
  double slowest = 1e-6;
  for (const graph::PassTimes& t : times) slowest = std::max(slowest, t.gpu_p95_ms);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float font = zoom_ * ImGui::GetFontSize();
  const auto text = [&](ImVec2 at, float size, ImU32 tone, const std::string& words) {
    if (size > 5) list->AddText(ImGui::GetFont(), size, at, tone, words.c_str());
  };
  over_node_ = false;
  for (const NodePlace& node : layout_.nodes) {
    const ImVec2 low = at(node.centre - .5F * node.size), high = at(node.centre + .5F * node.size);
    const bool over = hovered && ImGui::IsMouseHoveringRect(low, high);
    over_node_ = over_node_ || over;
    const float pad = 6 * zoom_;
    const graph::CompiledPass* pass = graph.pass(node.pass);
    const float round = 4 * zoom_;
    if (pass == nullptr) {
      list->AddRectFilled(low, high, IM_COL32(44, 60, 78, 255), round * 2);
      text({low.x + pad, low.y + pad * .7F}, font * .8F, packed(ImGui::GetStyleColorVec4(ImGuiCol_Text)),
           node.pass.substr(node.pass.find('.') + 1));
      continue;
    }
    const bool selected = node.pass == ui.selected_pass;
    const float strength = pass->runs ? 1.F : .45F;
    list->AddRectFilled(low, high, pass->runs ? IM_COL32(42, 47, 56, 255) : IM_COL32(30, 31, 35, 255), round);
    list->AddRect(low, high,
                  selected ? packed(colour::accent)
                  : over   ? packed(colour::dim)
                           : IM_COL32(72, 78, 90, 255),
                  round, 0, selected ? 2.5F : 1.F);
    const ImU32 plain = packed(ImGui::GetStyleColorVec4(ImGuiCol_Text), strength), dim = packed(colour::dim, strength);
    list->PushClipRect(low, high, true);
    text({low.x + pad, low.y + pad * .5F}, font, plain, node.pass);
    const graph::PassTimes* cost = times_of(times, node.pass);
    const std::string second = !pass->runs ? "does not run"
                               : cost == nullptr
                                   ? pass->type
                                   : fmt::format("{:.2f} ms  p95 {:.2f}", cost->gpu_median_ms, cost->gpu_p95_ms);
    text({low.x + pad, low.y + pad * .5F + 1.25F * font}, font * .82F, pass->runs ? plain : dim, second);
    text({low.x + pad, low.y + pad * .5F + 2.3F * font}, font * .82F, dim,
         pass->runs ? mebibytes(bytes_of(graph, node.pass)) : why_idle(graph, node.pass));
    list->PopClipRect();
    if (cost != nullptr && pass->runs) {
      const float width = high.x - low.x;
      const auto share = [&](double ms) {
        return low.x + width * static_cast<float>(std::clamp(ms / slowest, 0., 1.));
      };
      list->AddRectFilled({low.x, high.y - 4 * zoom_}, {share(cost->gpu_p95_ms), high.y}, packed(colour::accent, .35F),
                          round);
      list->AddRectFilled({low.x, high.y - 4 * zoom_}, {share(cost->gpu_median_ms), high.y}, packed(colour::accent),
                          round);
    }
    if (!over) continue;
    const std::string why = why_idle(graph, node.pass);
    ImGui::SetTooltip("%s (%s)%s%s", node.pass.c_str(), pass->type.c_str(),
                      why.empty() ? "" : "\nleft out: ", why.c_str());
    if (clicked) ui.select(node.pass);
  }
}

}  // namespace loom::viewer
