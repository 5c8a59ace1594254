#include "measure/stress.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <glm/vec4.hpp>

#include "graph/run/renderer.h"
#include "loom/diagnostic.h"
#include "scene/gpu_scene.h"
#include "scene/load.h"

namespace loom::measure {
namespace {

/// What goes wrong before the first frame is an answer, later it is a fault.
struct Refused {
  StressOutcome outcome;
  std::string why;
};

/// Half precision keeps 11 bits: a bound that holds exactly may be passed by half a unit in the last place, twice.
constexpr double rounding = 1 + 0x1p-10;

/// What the laws are about. Straight light alone would hide what bounces.
constexpr std::array<const char*, 2> judged{"hdr", "indirect"};

struct Rendering {
  std::array<graph::ReadImage, judged.size()> images;
  double brightest = 0;   ///< of hdr
  double bytes = 0;       ///< as planned
  std::string complaint;  ///< texels that no pass may make
};

std::string complaint_of(const graph::Renderer& renderer) {
  for (const graph::FiniteReport& r : renderer.finite_reports()) {
    if (r.non_finite > 0) {
      return fmt::format("{}.{} holds {} numbers that are not finite in frame {}", r.pass, r.member, r.non_finite,
                         r.frame);
    }
    if (r.negative > 0 && r.non_negative) {
      return fmt::format("{}.{} holds {} negative numbers in frame {}", r.pass, r.member, r.negative, r.frame);
    }
  }
  return {};
}

Rendering render(const StressCase& what, const StressPart& part, const Registry& registry, Device& device,
                 const StressLimits& limits) {
  const View& view = part.view;
  const SceneFacts facts = scene::compute_facts(view.scene);
  graph::CompileOptions options;
  options.frame_size = what.size;
  options.overrides = what.set;
  options.overrides.insert(options.overrides.end(), part.set.begin(), part.set.end());
  options.requested = {"image"};
  options.requested.insert(options.requested.end(), judged.begin(), judged.end());
  graph::CompileResult compiled = graph::compile_file(what.pipeline, registry, facts, options);
  if (!compiled.graph) {
    throw Refused{StressOutcome::refused,
                  compiled.diagnostics.all().empty() ? "" : compiled.diagnostics.all().front().message};
  }
  if (compiled.graph->bytes > limits.bytes) {
    throw Refused{StressOutcome::skipped, fmt::format("the plan takes {} MiB", compiled.graph->bytes >> 20)};
  }
  const auto bytes = static_cast<double>(compiled.graph->bytes);
  const auto gpu_scene = scene::GpuScene::create(view.scene);
  std::unique_ptr<graph::Renderer> renderer;
  try {
    renderer = graph::Renderer::create(std::move(*compiled.graph), device, {.poison = true, .check_finite = true});
  } catch (const Error& error) {
    throw Refused{StressOutcome::refused, error.what()};
  }
  for (int frame = 0; frame < what.frames; ++frame) {
    renderer->render(*gpu_scene, scene::make_camera(view.camera, view.scene, what.size, glm::dvec2(0)),
                     {.index = static_cast<std::uint64_t>(frame), .seed = 1});
  }
  Rendering rendering{.images = {}, .bytes = bytes, .complaint = complaint_of(*renderer)};
  for (std::size_t i = 0; i < judged.size(); ++i) rendering.images[i] = renderer->read(judged[i]);
  for (const glm::vec4& texel : rendering.images[0].texels) {
    rendering.brightest = std::max({rendering.brightest, static_cast<double>(texel.x), static_cast<double>(texel.y),
                                    static_cast<double>(texel.z)});
  }
  return rendering;
}

/// Adds weight × image, moved to the left by `shift` pixels; what has no partner in every image is left out by
/// `margin`.
void accumulate(std::vector<double>& sum, const graph::ReadImage& image, double weight, int shift, int margin) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x + margin < image.width; ++x) {
      const auto from =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x + shift);
      const auto to =
          3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
      for (int c = 0; c < 3; ++c) {
        sum[to + static_cast<std::size_t>(c)] += weight * static_cast<double>(image.texels[from][c]);
      }
    }
  }
}

double norm(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  if (largest == 0) return 0;
  double sum = 0;
  for (const double v : values) sum += (v / largest) * (v / largest);
  return largest * std::sqrt(sum);
}

StressResult judge(const StressCase& what, const std::vector<StressPart>& parts, const Registry& registry,
                   Device& device, const StressLimits& limits) {
  StressResult result;
  std::array<std::vector<double>, judged.size()> sums, firsts;
  int margin = 0;
  double first_bytes = 0;
  for (const StressPart& part : parts) margin = std::max(margin, part.shift);
  for (const StressPart& part : parts) {
    const Rendering rendering = render(what, part, registry, device, limits);
    if (!rendering.complaint.empty()) return {StressOutcome::broken, rendering.complaint};
    if (first_bytes == 0) first_bytes = rendering.bytes;
    result.saved = first_bytes - rendering.bytes;
    const double bound = furnace_bound(part.view.scene);
    if (rendering.brightest > 0) result.share = std::max(result.share, rendering.brightest / bound);
    for (std::size_t i = 0; i < judged.size(); ++i) {
      if (sums[i].empty()) sums[i].assign(3 * rendering.images[i].texels.size(), 0);
      accumulate(sums[i], rendering.images[i], part.weight, part.shift, margin);
      if (firsts[i].empty()) firsts[i] = sums[i];
    }
  }
  for (std::size_t i = 0; i < judged.size() && parts.size() > 1; ++i) {
    const double size = norm(firsts[i]);
    result.error = std::max(result.error, size > 0 ? norm(sums[i]) / size : norm(sums[i]));
  }
  if (what.bounded && result.share > rounding) {
    result.outcome = StressOutcome::broken;
    result.message =
        fmt::format("brighter than all reflections together can be: {:.3g} × the furnace bound", result.share);
  } else if (!(result.error <= what.tolerance)) {
    result.outcome = StressOutcome::broken;
    result.message = fmt::format("off by {:.3g} (relative L2), {:.3g} is allowed", result.error, what.tolerance);
  }
  return result;
}

}  // namespace

std::string StressCase::id() const {
  return fmt::format("{} | {} | {}", std::filesystem::path(pipeline).stem().string(), group, name);
}

StressResult run_stress(const StressCase& what, const Registry& registry, Device& device, const StressLimits& limits) {
  try {
    return judge(what, what.parts(), registry, device, limits);
  } catch (const Refused& refused) {
    return {refused.outcome, refused.why};
  } catch (const std::exception& error) {
    return {StressOutcome::broken, error.what()};
  }
}

}  // namespace loom::measure
