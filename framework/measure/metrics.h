#pragma once
// Numbers that say how far an image is from the truth. docs/metrics.md has each one's equation and what it is
// sensitive to.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "loom/export.h"
#include "measure/flip.h"
#include "measure/layers.h"

namespace loom::measure {

/// Every mean runs over the channels of the valid pixels: those of the mask where A is finite. Sums are double and in a
/// fixed order, so that the same images give the same bits on any number of threads. With no valid pixel, and where a
/// ratio has no value (a black reference), the number is NaN.
struct Metrics {
  double relmse = 0;             ///< mean of (a−r)²/(r²+1e-2)
  double rmse = 0;               ///< √ mean of (a−r)², in the unit of the image
  double smape = 0;              ///< mean of |a−r|/(|a|+|r|+1e-2), 0 … 1
  std::optional<double> flip;    ///< mean of the FLIP map, 0 … 1; none for layers that are no colours
  double mean_ratio = 0;         ///< Σa/Σr
  double p99_abs = 0;            ///< 99th percentile of |a−r|, linear between order statistics
  std::uint64_t non_finite = 0;  ///< pixels of the mask where A has a NaN or an infinity; not in the means
  std::uint64_t pixels = 0;      ///< valid pixels
};

/// Which pixels count: empty for all, else one byte a pixel, 0 = does not count.
using Mask = std::span<const std::uint8_t>;

/// All but `flip`. Layers of equal size and channel count. Throws BadInput naming the first pixel where the reference
/// is not finite, anywhere in the image.
LOOM_API Metrics compute_metrics(const Layer& a, const Layer& reference, Mask mask = {});

/// Metrics, and the FLIP map behind `metrics.flip`.
struct Comparison {
  Metrics metrics;
  std::optional<FlipMap> flip;
};

/// HDR-FLIP where `hdr`, else LDR-FLIP; none for layers that are no colours.
LOOM_API Comparison compare(const Layer& a, const Layer& reference, bool hdr, Mask mask = {});

/// 1 where every channel of `layer` is finite and the first is above 0 (depth: something is seen).
LOOM_API std::vector<std::uint8_t> mask_of(const Layer& layer);

}  // namespace loom::measure
