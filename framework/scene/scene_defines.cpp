#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "loom/facts.h"
#include "loom/gpu.h"
#include "loom/scene_view.h"

namespace loom {

std::vector<glm::dvec3> SceneView::sky_harmonics(int order) const {
  std::vector<glm::dvec3> result(static_cast<std::size_t>((order + 1) * (order + 1)), glm::dvec3(0));
  result[0] = glm::dvec3(static_cast<float>(std::sqrt(4 * std::numbers::pi)) * sky_radiance());
  return result;
}

std::vector<Define> scene_defines(const SceneFacts& facts) {
  std::vector<Define> defines;
  if (facts.textures || facts.normal_maps) defines.emplace_back("SCENE_TEXTURES", "1");
  if (facts.normal_maps) defines.emplace_back("SCENE_NORMAL_MAPS", "1");
  if (facts.alpha_mask) defines.emplace_back("SCENE_ALPHA_MASK", "1");
  if (facts.sky_image) defines.emplace_back("SCENE_SKY_IMAGE", "1");
  return defines;
}

}  // namespace loom
