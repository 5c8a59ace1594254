#pragma once
// FLIP: the error that a person sees when flipping between two images.
//   LDR: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator for
//   Alternating
//        Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020.
//   HDR: Andersson, Nilsson, Shirley, Akenine-Möller: "Visualizing Errors in Rendered High Dynamic Range Images",
//        Eurographics Short Papers, 2021.
#include <optional>
#include <vector>

#include "loom/export.h"
#include "measure/layers.h"

namespace loom::measure {

/// A 0.7 m wide 4K monitor seen from 0.7 m: 0.7 · 3840/0.7 · π/180.
inline constexpr double default_pixels_per_degree = 67.0206;

/// Exposures in stops (2^x), evenly spaced from start to stop, both included.
struct Exposures {
  double start = 0, stop = 0;
  int count = 2;
};

struct FlipMap {
  int width = 0, height = 0;
  std::vector<float> error;  ///< 0 … 1 a pixel, row 0 at the top
  double mean = 0;
  std::optional<Exposures> exposures;  ///< set by HDR-FLIP
};

/// Linear Rec.709, clamped to [0,1]. Both layers have three channels R G B and one size; the reference is finite. Where
/// A is not finite the error is 1, and its neighbours see the reference's colour there.
LOOM_API FlipMap flip_ldr(const Layer& a, const Layer& reference, double pixels_per_degree = default_pixels_per_degree);

/// Linear Rec.709 of any range (negative counts as 0): the largest LDR-FLIP error of each pixel over the exposures,
/// tone mapped with ACES. The exposures follow from the reference alone, so HDR-FLIP is not symmetric.
LOOM_API FlipMap flip_hdr(const Layer& a, const Layer& reference, double pixels_per_degree = default_pixels_per_degree);

/// From where the reference's brightest pixel, to where its median is mapped to 85 % of the display's range; one
/// exposure a stop, two at least.
LOOM_API Exposures automatic_exposures(const Layer& reference);

}  // namespace loom::measure
