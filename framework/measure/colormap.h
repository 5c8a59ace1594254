#pragma once
// Colours for error maps.
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "loom/export.h"

namespace loom::measure {

/// Magma at 0 … 1 (clamped; NaN is 1), sRGB-encoded: black for no error, through purple and orange to pale yellow.
LOOM_API glm::vec3 magma(float value);

/// An error map as PNG, in magma.
LOOM_API void write_heatmap(const std::string& path, int width, int height, std::span<const float> error);

}  // namespace loom::measure
