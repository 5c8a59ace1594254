#include "loom/rules.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <variant>

#include <fmt/format.h>
#include <glm/common.hpp>

namespace loom::rules {
namespace {

constexpr double pi = std::numbers::pi;
/// Steps beyond which a coarser cascade is the better means.
constexpr int most_iterations = 64;

double volume(const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 extent = glm::max(high - low, glm::dvec3(0));
  return extent.x * extent.y * extent.z;
}

bool lit_box_is_enough(const Ports& ports, const SceneFacts& facts) {
  if (!facts.measured || facts.moves || !ports.rule("bounds")) return false;
  const double lit = volume(facts.measured->lit_min, facts.measured->lit_max);
  return lit > 0 && lit < .5 * volume(facts.bounds_min, facts.bounds_max);
}

/// The smallest n with ρⁿ⁺¹ below the threshold.
int needed_bounces(double albedo) {
  if (albedo >= 1) return INT_MAX;
  if (albedo <= 0) return 1;
  const double n = std::floor(std::log(bounces_threshold) / std::log(albedo));
  return n < INT_MAX ? std::max(1, static_cast<int>(n)) : INT_MAX;
}

}  // namespace

int channels(const Ports& ports, const SceneFacts& facts) {
  return facts.max_chroma <= achromatic_threshold && ports.rule("achromatic") ? 1 : 3;
}

int channels(std::initializer_list<InputPort> inputs) {
  int most = 1;
  for (const InputPort& input : inputs)
    if (!input.absent()) most = std::max(most, input.attribute("channels", 3));
  return most;
}

int bounces(const Ports& ports, double max_albedo) {
  return ports.rule("bounces") ? needed_bounces(max_albedo) : INT_MAX;
}

double max_albedo(const InputPort& input) {
  if (input.absent()) return 1;
  const auto found = input.info()->attributes.find("max_albedo");
  if (found == input.info()->attributes.end()) return 1;
  const double* albedo = std::get_if<double>(&found->second);
  return albedo == nullptr ? 1 : *albedo;
}

void decide_bounces(Ports& ports, double max_albedo, int allowed) {
  const int needed = bounces(ports, max_albedo);
  if (!ports.rule("bounces")) return;
  const std::string evidence = fmt::format("albedo up to {:.3g}", max_albedo);
  if (needed < allowed) {
    ports.decide("bounces", fmt::format("{} orders of reflection instead of {}", needed, allowed), evidence);
  } else if (needed > allowed) {
    ports.decide("bounces", fmt::format("capped at {} orders of reflection by the parameter", allowed),
                 fmt::format("{}: up to {:.1f} % of all light is of higher order", evidence,
                             100 * std::pow(max_albedo, allowed + 1)));
  }
}

int iterations(const Ports& ports, int cells) {
  return ports.rule("iterations") ? std::max(1, 2 * cells * cells) : INT_MAX;
}

void decide_iterations(Ports& ports, int cells, int allowed) {
  if (!ports.rule("iterations")) return;
  const int needed = iterations(ports, cells);
  const std::string evidence = fmt::format("2k² for k = {} cells from wall to wall", cells);
  if (needed < allowed) {
    ports.decide("iterations", fmt::format("{} steps instead of {}", needed, allowed), evidence);
  } else if (needed > most_iterations && allowed < needed) {
    ports.decide("iterations", fmt::format("{} steps do not cross the grid, {} would", allowed, needed),
                 evidence + "; a coarser grid or one more cascade is the cheaper remedy");
  }
}

double above_band(const SceneMeasurements& measured, int order) {
  // Of the clamped cosine; odd bands above the first are zero.
  constexpr std::array<double, SceneMeasurements::bands> kernel = {pi, 2 * pi / 3, pi / 4, 0,        -pi / 24,
                                                                   0,  pi / 64,    0,      -pi / 128};
  double above = 0, all = 0;
  for (std::size_t l = 0; l < kernel.size(); ++l) {
    const double energy = kernel.at(l) * kernel.at(l) * std::max(0., measured.radiance.at(l));
    all += energy;
    if (static_cast<int>(l) > order) above += energy;
  }
  return all > 0 ? above / all : 0;
}

int bands(Ports& ports, const SceneFacts& facts, int allowed) {
  if (!ports.rule("bands") || !facts.measured || facts.measured->probes == 0) return allowed;
  int order = 0;
  while (order < allowed && above_band(*facts.measured, order) >= bands_threshold) ++order;
  if (order < allowed)
    ports.decide("bands", fmt::format("order {} instead of {}", order, allowed),
                 fmt::format("{:.2g} of the mean square of irradiance is above it, at {} probes",
                             above_band(*facts.measured, order), facts.measured->probes));
  return order;
}

Bounds bounds(const Ports& ports, const SceneFacts& facts) {
  if (lit_box_is_enough(ports, facts)) return {facts.measured->lit_min, facts.measured->lit_max};
  return {facts.bounds_min, facts.bounds_max};
}

std::string bounds_text(const Ports& ports, const SceneFacts& facts) {
  if (!lit_box_is_enough(ports, facts)) return "longest side of the scene's box";
  const double share =
      volume(facts.measured->lit_min, facts.measured->lit_max) / volume(facts.bounds_min, facts.bounds_max);
  return fmt::format("longest side of the lit box, {:.0f} % of the scene's", 100 * share);
}

}  // namespace loom::rules
