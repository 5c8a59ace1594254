#pragma once
// From an output of the graph to a picture file.
#include <string>

#include "graph/run/renderer.h"
#include "loom/export.h"

namespace loom::measure {

/// Writes the picture. EXR: R, G, B in 32-bit float, attributes loom:quantity and loom:output (`output`, by which
/// compare tells bounce from indirect irradiance). PNG: display-referred values as they are; anything else clamped to
/// [0, 1] and sRGB-encoded. Layers and slices are laid side by side, in rows.
LOOM_API void write_image(const std::string& path, bool png, const graph::ReadImage& image, const std::string& output);

}  // namespace loom::measure
