#pragma once
// The filters of FLIP: contrast sensitivity of the eye (what is too fine to be seen at this distance is blurred away)
// and detectors of edges and points. All are separable; a kernel keeps its non-negative side.
#include <cstddef>
#include <span>
#include <vector>

namespace loom::measure::flip {

/// Weights at offsets 0 … r. Even: w(−k) = w(k). Odd: w(−k) = −w(k), w(0) = 0.
using HalfKernel = std::vector<float>;

struct Filters {
  /// `pixels_per_degree` > 0.
  explicit Filters(double pixels_per_degree);

  HalfKernel achromatic, red_green;  ///< contrast sensitivity, unit sum
  HalfKernel blue_yellow[2];         ///< the same as a sum of two separable Gaussians …
  float blue_yellow_share[2];        ///< … in these shares, which sum to 1
  HalfKernel gaussian;               ///< across the direction of a detector, unit sum
  HalfKernel edge;                   ///< odd: derivative of the Gaussian, lobes of ±1
  HalfKernel point;                  ///< even: second derivative, positive lobes sum to 1, negative to −1
  std::size_t radius = 0;            ///< of the widest
};

/// out[x] = Σ w(k)·in[x+k]; `padded` has `radius` more values at both ends than `out`.
void filter_even(std::span<float> out, std::span<const float> padded, std::size_t radius, const HalfKernel& kernel);
void filter_odd(std::span<float> out, std::span<const float> padded, std::size_t radius, const HalfKernel& kernel);

/// The same down the columns of a plane whose rows are as long as `out`, at row y; rows beyond the border repeat it.
void filter_even_at_row(std::span<float> out, std::span<const float> plane, std::size_t y, const HalfKernel& kernel);
void filter_odd_at_row(std::span<float> out, std::span<const float> plane, std::size_t y, const HalfKernel& kernel);

}  // namespace loom::measure::flip
