#pragma once
// Sub-pixel samples of one frame: where they lie, and their mean.
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "graph/run/renderer.h"
#include "loom/export.h"

namespace loom::measure {

/// Offsets from the pixel's centre, each within ±.5 pixel. One sample lies at the centre; n samples take every one of
/// the n columns and rows once (Hammersley, its second coordinate by rank), so that their mean is the centre for any n.
LOOM_API std::vector<glm::dvec2> jitter(int samples);

/// Mean of an output over samples: a box filter of one pixel. Display-referred values are averaged as light, that is
/// after decoding their sRGB curve, and encoded again.
class LOOM_API Mean {
 public:
  void add(const graph::ReadImage& image);
  [[nodiscard]] graph::ReadImage image() const;

 private:
  graph::ReadImage first_;  ///< size and quantity
  std::vector<glm::dvec4> sum_;
  int count_ = 0;
};

}  // namespace loom::measure
