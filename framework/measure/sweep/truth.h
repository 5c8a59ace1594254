#pragma once
// The reference that a scene's pictures are measured against: made when it is first asked for, kept by what it is of.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "loom/export.h"
#include "measure/layers.h"
#include "measure/sweep/sweep.h"
#include "reference/run.h"
#include "scene/load.h"

namespace loom::measure {

/// relMSE of radiance, indirect and bounce.
struct TruthErrors {
  double hdr = 0, indirect = 0, bounce = 0;
};

struct Truth {
  std::string id;  ///< of scene content, camera, size and target
  ImageFile file;
  std::uint32_t spp = 0;
  double seconds = 0;            ///< of path tracing
  double noise = 0;              ///< relMSE of its radiance, as the layer `stderr` has it
  TruthErrors without_indirect;  ///< error of a perfect picture that lacks all indirect light
  struct Step {
    std::uint32_t spp = 0;
    double seconds = 0, relmse = 0;  ///< of radiance
  };
  std::vector<Step> convergence;
};

/// Where references are kept unless told otherwise: `lightloom/references` in the user's cache folder.
LOOM_API std::string default_truth_folder();
LOOM_API std::string truth_id(const scene::Setup& setup, glm::ivec2 size, const TruthTarget& target);
/// From the folder, or path-traced; `report` as for reference::run().
LOOM_API Truth obtain_truth(const std::string& folder, const scene::Setup& setup, glm::ivec2 size,
                            const TruthTarget& target,
                            const std::function<bool(const reference::Progress&)>& report = {});

}  // namespace loom::measure
