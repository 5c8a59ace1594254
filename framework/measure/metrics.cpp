#include "measure/metrics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "loom/diagnostic.h"

namespace loom::measure {
namespace {

/// Keeps the quotients of relMSE and SMAPE finite where the reference is black, in the image's unit (squared for
/// relMSE); DESIGN's definition, so that figures of all pipelines can be put side by side.
constexpr double epsilon = 1e-2;
constexpr double percentile = .99;

void check_shapes(const Layer& a, const Layer& reference, Mask mask) {
  if (a.width != reference.width || a.height != reference.height || a.planes.size() != reference.planes.size()) {
    throw BadInput("layers of different sizes or channel counts cannot be compared");
  }
  if (!mask.empty() && mask.size() != a.pixels()) throw BadInput("the mask has another size than the images");
}

void check_reference(const Layer& reference) {
  const auto not_finite = [](float v) { return !std::isfinite(v); };
  for (std::size_t c = 0; c < reference.planes.size(); ++c) {
    const auto plane = reference.planes[c];
    const auto bad = std::find_if(plane.begin(), plane.end(), not_finite);
    if (bad == plane.end()) continue;
    const auto index = static_cast<std::size_t>(bad - plane.begin());
    const auto width = static_cast<std::size_t>(reference.width);
    const std::string pixel = "(" + std::to_string(index % width) + ", " + std::to_string(index / width) + ")";
    Diagnostics diagnostics;
    diagnostics.error("reference-not-finite",
                      "the reference is " + std::string(std::isnan(*bad) ? "NaN" : "infinite") + " at pixel " + pixel +
                          " of channel " + reference.channels[c] + ", which has " +
                          std::to_string(std::count_if(bad, plane.end(), not_finite)) + " such values",
                      {}, "nothing can be measured against it: render the reference again");
    throw BadInput(std::move(diagnostics));
  }
}

struct RowSums {
  double relative = 0, squared = 0, symmetric = 0, a = 0, r = 0;
  std::uint64_t pixels = 0, non_finite = 0;
};

/// `differences` gets |a−r| of each channel of each valid pixel, from its start; returns the row's sums.
RowSums sum_row(const Layer& a, const Layer& reference, Mask mask, std::size_t row, std::span<double> differences) {
  RowSums sums;
  const auto width = static_cast<std::size_t>(a.width);
  std::size_t written = 0;
  for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
    if (!mask.empty() && mask[i] == 0) continue;
    const bool finite = std::all_of(a.planes.begin(), a.planes.end(), [i](auto p) { return std::isfinite(p[i]); });
    if (!finite) {
      ++sums.non_finite;
      continue;
    }
    ++sums.pixels;
    for (std::size_t c = 0; c < a.planes.size(); ++c) {
      const double va = a.planes[c][i];
      const double vr = reference.planes[c][i];
      const double difference = std::abs(va - vr);
      sums.relative += difference * difference / (vr * vr + epsilon);
      sums.squared += difference * difference;
      sums.symmetric += difference / (std::abs(va) + std::abs(vr) + epsilon);
      sums.a += va;
      sums.r += vr;
      differences[written++] = difference;
    }
  }
  return sums;
}

/// Linear between the two order statistics around rank p·(n−1).
double quantile(std::vector<double>& values, double p) {
  const double rank = p * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(rank);
  const auto at_low = values.begin() + static_cast<std::ptrdiff_t>(low);
  std::nth_element(values.begin(), at_low, values.end());
  if (low + 1 == values.size()) return *at_low;
  const double next = *std::min_element(at_low + 1, values.end());
  return *at_low + (rank - static_cast<double>(low)) * (next - *at_low);
}

bool is_valid(const Layer& a, Mask mask, std::size_t i) {
  return (mask.empty() || mask[i] != 0) &&
         std::all_of(a.planes.begin(), a.planes.end(), [i](auto p) { return std::isfinite(p[i]); });
}

}  // namespace

Metrics compute_metrics(const Layer& a, const Layer& reference, Mask mask) {
  check_shapes(a, reference, mask);
  check_reference(reference);
  const auto rows = static_cast<std::size_t>(a.height);
  const std::size_t row_values = static_cast<std::size_t>(a.width) * a.planes.size();
  std::vector<RowSums> sums(rows);
  std::vector<double> differences(rows * row_values);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t row = range.begin(); row < range.end(); ++row) {
      sums[row] = sum_row(a, reference, mask, row, std::span(differences).subspan(row * row_values, row_values));
    }
  });
  RowSums total;
  std::size_t kept = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    const RowSums& s = sums[row];
    total.relative += s.relative;
    total.squared += s.squared;
    total.symmetric += s.symmetric;
    total.a += s.a;
    total.r += s.r;
    total.pixels += s.pixels;
    total.non_finite += s.non_finite;
    const auto from = differences.begin() + static_cast<std::ptrdiff_t>(row * row_values);
    const std::size_t count = s.pixels * a.planes.size();
    std::copy_n(from, count, differences.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += count;
  }
  differences.resize(kept);
  // With no valid value 0/0 makes every mean NaN, as the contract says.
  const auto n = static_cast<double>(kept);
  return {.relmse = total.relative / n,
          .rmse = std::sqrt(total.squared / n),
          .smape = total.symmetric / n,
          .flip = std::nullopt,
          .mean_ratio = total.r == 0 ? std::numeric_limits<double>::quiet_NaN() : total.a / total.r,
          .p99_abs = kept == 0 ? std::numeric_limits<double>::quiet_NaN() : quantile(differences, percentile),
          .non_finite = total.non_finite,
          .pixels = total.pixels};
}

Comparison compare(const Layer& a, const Layer& reference, bool hdr, Mask mask) {
  Comparison result{.metrics = compute_metrics(a, reference, mask), .flip = std::nullopt};
  if (!a.is_color() || !reference.is_color()) return result;
  result.flip = hdr ? flip_hdr(a, reference) : flip_ldr(a, reference);
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    if (is_valid(a, mask, i)) sum += static_cast<double>(result.flip->error[i]);
  }
  result.metrics.flip = sum / static_cast<double>(result.metrics.pixels);
  return result;
}

std::vector<std::uint8_t> mask_of(const Layer& layer) {
  std::vector<std::uint8_t> mask(layer.pixels());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask[i] = is_valid(layer, {}, i) && layer.planes[0][i] > 0 ? 1 : 0;
  }
  return mask;
}

}  // namespace loom::measure
