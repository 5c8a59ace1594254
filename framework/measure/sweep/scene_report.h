#pragma once
// What a report says about a scene, whatever the pipeline: its reference, and what sampling alone costs.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "loom/export.h"
#include "loom/registry.h"
#include "measure/sweep/truth.h"

namespace loom::measure {

struct SceneReport {
  std::string name, camera;
  glm::ivec2 size{0};
  int samples = 1;
  std::string truth;  ///< id of the reference
  std::uint32_t spp = 0;
  double seconds = 0;  ///< that it took
  double noise = 0;    ///< relMSE of its radiance
  TruthErrors without_indirect;
  std::vector<Truth::Step> convergence;
  /// relMSE of hdr that sampling a pixel at so few places costs any rasterising pipeline (see measure_aliasing()).
  double aliasing = 0;
  std::string device;
};

struct SceneJob {
  const SweepScene& scene;
  const Settings& settings;
  glm::ivec2 size;
  const Registry& registry;
  std::vector<std::string> shader_roots;
  std::string truth_folder;
  std::string folder;  ///< of the report: `scenes/<truth id>-<samples>.{json,png}` lie in it
};

/// The reference (made if need be), the floor of sampling, and the reference's picture, tone-mapped as pipelines do by
/// default. What lies in the folder is not made again.
LOOM_API SceneReport report_scene(const SceneJob& job,
                                  const std::function<bool(const reference::Progress&)>& progress = {});
/// The same from the folder alone. Nothing where it is not there.
LOOM_API std::vector<SceneReport> read_scene_reports(const std::string& folder);
/// Path of the picture and the JSON, without their endings, relative to the report's folder.
LOOM_API std::string scene_stem(const SceneReport& report);

}  // namespace loom::measure
