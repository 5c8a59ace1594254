#include <vector>

#include "loom/facts.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"

namespace loom {

std::vector<Define> scene_defines(const SceneFacts& facts) {
  std::vector<Define> defines;
  if (facts.textures || facts.normal_maps) defines.emplace_back("SCENE_TEXTURES", "1");
  if (facts.normal_maps) defines.emplace_back("SCENE_NORMAL_MAPS", "1");
  if (facts.alpha_mask) defines.emplace_back("SCENE_ALPHA_MASK", "1");
  return defines;
}

}  // namespace loom
