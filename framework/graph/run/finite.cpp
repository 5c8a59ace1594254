#include "graph/run/finite.h"

#include <cmath>
#include <string>
#include <utility>

#include "loom/gpu.h"

namespace loom::graph {
namespace {

/// Coefficients and normals have signs; light that arrives or leaves does not.
bool is_light(const Bundle& bundle) {
  if (bundle.type == "Irradiance") return true;
  const auto it = bundle.attributes.find("quantity");
  const auto* quantity = it == bundle.attributes.end() ? nullptr : std::get_if<std::string>(&it->second);
  return quantity != nullptr && (*quantity == "radiance" || *quantity == "irradiance" || *quantity == "display");
}

}  // namespace

void count_bad_numbers(const CompiledGraph& graph, const CompiledPass& pass, const Storage& storage,
                       std::uint64_t frame, std::vector<FiniteReport>& reports) {
  for (const BoundPort& port : pass.bound) {
    if (port.is_input || port.name == "scratch" || port.name == "persistent") continue;
    for (const BoundMember& member : port.members) {
      const Texture* texture = member.resource == none ? nullptr : storage.texture(member.resource);
      if (!texture || is_integer(texture->desc().format)) continue;
      FiniteReport report{.pass = pass.name, .member = port.name + "." + member.name, .frame = frame};
      report.non_negative = port.bundle != none && is_light(graph.bundles[static_cast<std::size_t>(port.bundle)]);
      for (const glm::vec4& texel : texture->read()) {
        for (int c = 0; c < 4; ++c) {
          report.non_finite += std::isfinite(texel[c]) ? 0 : 1;
          report.negative += texel[c] < 0 ? 1 : 0;
        }
      }
      if (report.non_finite + report.negative > 0) reports.push_back(std::move(report));
    }
  }
}

}  // namespace loom::graph
