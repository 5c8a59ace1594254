#include "measure/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace loom::measure::flip {
namespace {

constexpr double pi = std::numbers::pi;

/// A contrast sensitivity function, a·√(π/b)·exp(−π²x²/b) with x in degrees: a Gaussian of σ = √(b/2)/π.
/// Constants: LDR paper, table 1.
struct Sensitivity {
  double a, b;
  [[nodiscard]] double weight() const { return a * std::sqrt(pi / b); }
  [[nodiscard]] double sigma_degrees() const { return std::sqrt(b / 2) / pi; }
};
constexpr Sensitivity achromatic_csf{1, .0047};
constexpr Sensitivity red_green_csf{1, .0053};
constexpr Sensitivity blue_yellow_csf[2] = {{34.1, .04}, {13.5, .025}};

/// Width in degrees of the smallest feature that the eye finds (LDR paper, section 4.2); σ is half of it.
constexpr double feature_degrees = .082;

/// Gaussians end at three standard deviations (both papers).
std::size_t radius_of(double sigma) { return static_cast<std::size_t>(std::ceil(3 * sigma)); }

std::vector<double> gaussian_weights(double sigma, std::size_t radius) {
  std::vector<double> weights(radius + 1);
  for (std::size_t k = 0; k <= radius; ++k) {
    const auto x = static_cast<double>(k);
    weights[k] = std::exp(-x * x / (2 * sigma * sigma));
  }
  return weights;
}

double full_sum(const std::vector<double>& half) {
  double sum = half[0];
  for (std::size_t k = 1; k < half.size(); ++k) sum += 2 * half[k];
  return sum;
}

HalfKernel scaled(const std::vector<double>& weights, double factor) {
  // A tail this small is lost in the rounding of a float sum: leaving it out changes nothing but the time.
  constexpr double negligible = 1e-9;
  HalfKernel kernel;
  for (const double w : weights) kernel.push_back(static_cast<float>(w * factor));
  while (kernel.size() > 1 && std::abs(static_cast<double>(kernel.back())) < negligible) kernel.pop_back();
  return kernel;
}

HalfKernel unit_gaussian(double sigma, std::size_t radius) {
  const std::vector<double> weights = gaussian_weights(sigma, radius);
  return scaled(weights, 1 / full_sum(weights));
}

HalfKernel edge_kernel(double sigma, std::size_t radius) {
  std::vector<double> weights = gaussian_weights(sigma, radius);
  double lobe = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    weights[k] *= static_cast<double>(k);
    lobe += weights[k];
  }
  return scaled(weights, 1 / lobe);
}

HalfKernel point_kernel(double sigma, std::size_t radius) {
  std::vector<double> weights = gaussian_weights(sigma, radius);
  double positive = 0, negative = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const auto x = static_cast<double>(k);
    weights[k] *= x * x / (sigma * sigma) - 1;
    (weights[k] > 0 ? positive : negative) += (k == 0 ? 1 : 2) * weights[k];
  }
  for (double& w : weights) w /= w > 0 ? positive : -negative;
  return scaled(weights, 1);
}

std::span<const float> row_of(std::span<const float> plane, std::size_t width, std::size_t y) {
  return plane.subspan(y * width, width);
}

/// out += w·(a + sign·b)
template <int sign>
void add_pair(std::span<float> out, std::span<const float> a, std::span<const float> b, float w) {
  const std::size_t n = out.size();
  float* const o = out.data();
  const float* const pa = a.data();
  const float* const pb = b.data();
  for (std::size_t x = 0; x < n; ++x) o[x] += w * (sign > 0 ? pa[x] + pb[x] : pa[x] - pb[x]);
}

void set_scaled(std::span<float> out, std::span<const float> in, float w) {
  for (std::size_t x = 0; x < out.size(); ++x) out[x] = w * in[x];
}

template <int sign>
void filter(std::span<float> out, std::span<const float> padded, std::size_t radius, const HalfKernel& kernel) {
  set_scaled(out, padded.subspan(radius, out.size()), kernel[0]);
  for (std::size_t k = 1; k < kernel.size(); ++k) {
    add_pair<sign>(out, padded.subspan(radius + k, out.size()), padded.subspan(radius - k, out.size()), kernel[k]);
  }
}

template <int sign>
void filter_at_row(std::span<float> out, std::span<const float> plane, std::size_t y, const HalfKernel& kernel) {
  const std::size_t width = out.size();
  const std::size_t last = plane.size() / width - 1;
  set_scaled(out, row_of(plane, width, y), kernel[0]);
  for (std::size_t k = 1; k < kernel.size(); ++k) {
    add_pair<sign>(out, row_of(plane, width, std::min(y + k, last)), row_of(plane, width, y - std::min(k, y)),
                   kernel[k]);
  }
}

}  // namespace

Filters::Filters(double pixels_per_degree) {
  const auto sigma = [&](const Sensitivity& csf) { return csf.sigma_degrees() * pixels_per_degree; };
  // One window for all channels, wide enough for the widest; its weights sum to 1 as a square of pixels.
  const std::size_t window = radius_of(sigma(blue_yellow_csf[0]));
  achromatic = unit_gaussian(sigma(achromatic_csf), window);
  red_green = unit_gaussian(sigma(red_green_csf), window);
  double volume[2];
  for (int i = 0; i < 2; ++i) {
    blue_yellow[i] = unit_gaussian(sigma(blue_yellow_csf[i]), window);
    const double sum = full_sum(gaussian_weights(sigma(blue_yellow_csf[i]), window));
    volume[i] = blue_yellow_csf[i].weight() * sum * sum;
  }
  for (int i = 0; i < 2; ++i) blue_yellow_share[i] = static_cast<float>(volume[i] / (volume[0] + volume[1]));

  const double feature_sigma = .5 * feature_degrees * pixels_per_degree;
  const std::size_t feature_radius = radius_of(feature_sigma);
  gaussian = unit_gaussian(feature_sigma, feature_radius);
  edge = edge_kernel(feature_sigma, feature_radius);
  point = point_kernel(feature_sigma, feature_radius);
  radius = std::max(window, feature_radius);
}

void filter_even(std::span<float> out, std::span<const float> padded, std::size_t radius, const HalfKernel& kernel) {
  filter<1>(out, padded, radius, kernel);
}
void filter_odd(std::span<float> out, std::span<const float> padded, std::size_t radius, const HalfKernel& kernel) {
  filter<-1>(out, padded, radius, kernel);
}
void filter_even_at_row(std::span<float> out, std::span<const float> plane, std::size_t y, const HalfKernel& kernel) {
  filter_at_row<1>(out, plane, y, kernel);
}
void filter_odd_at_row(std::span<float> out, std::span<const float> plane, std::size_t y, const HalfKernel& kernel) {
  filter_at_row<-1>(out, plane, y, kernel);
}

}  // namespace loom::measure::flip
