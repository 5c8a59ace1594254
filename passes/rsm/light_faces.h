#pragma once
// Where each light looks: the faces (layers) of its maps.
#include <span>
#include <vector>

#include "interop/light.h"
#include "loom/facts.h"

namespace rsm {

/// One face for a spot of half-angle ≤ 60° (its field of view is the outer cone) and for a directional light (a box
/// around the scene's bounds), six cube faces (+X −X +Y −Y +Z −Z) for a point light and a wider spot. In the order of
/// Light::direction.w; as many as Light::intensity.w says.
std::vector<loom::interop::LightFace> light_faces(std::span<const loom::interop::Light> lights,
                                                  const loom::SceneFacts& facts);

}  // namespace rsm
