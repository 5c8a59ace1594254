#pragma once
// FLIP once more, straight from the papers: two-dimensional kernels, double precision, YCxCz as printed. Slow, and the
// yardstick of the separable one.
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "core/image_io.h"

namespace loom::test {

/// Error of each pixel of two linear images in [0,1].
std::vector<double> naive_flip(const ImageLayers& a, const ImageLayers& reference, double pixels_per_degree);

/// The colour part for two uniform images, which have no features and which blurring leaves as they are.
double naive_flip_of_colors(glm::dvec3 a, glm::dvec3 reference);

/// ACES at 2^exposure, clamped to [0,1].
double naive_aces(double value, double exposure);

}  // namespace loom::test
