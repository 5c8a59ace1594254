#pragma once
// How sure a mean over an image is.
#include <vector>

#include "loom/export.h"

namespace loom::measure {

struct Interval {
  double low = 0, high = 0;
};

/// 95 % interval of the mean of `values` (a pixel each, rows of `width`; NaN does not count) by the block bootstrap:
/// neighbouring pixels err alike, so blocks an eighth of the image wide and high are drawn with replacement, a thousand
/// times (Künsch 1989; Hall 1985 for two dimensions). The same values give the same interval.
LOOM_API Interval block_bootstrap(const std::vector<double>& values, int width, int height);

}  // namespace loom::measure
