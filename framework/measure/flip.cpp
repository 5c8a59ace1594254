#include "measure/flip.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "loom/diagnostic.h"
#include "measure/flip_color.h"
#include "measure/flip_filters.h"

namespace loom::measure {
namespace {

using flip::Filters;
using Rows = tbb::blocked_range<std::size_t>;

/// Rows a task takes: enough to make its buffers worth their allocation.
constexpr std::size_t grain = 8;

/// Linear Rec.709, every value finite.
struct Source {
  std::size_t width = 0, height = 0;
  std::array<std::span<const float>, 3> rgb;
};

/// What the vertical filters need of one image. Colour is kept as differences of white-relative tristimulus values,
///   y = Y/Yn, cx = X/Xn − Y/Yn, cz = Y/Yn − Z/Zn,
/// which is the papers' YCxCz without its factors 116, 500, 200 and offset −16: they cancel, since every filter below
/// is linear and sums to 1 (or, for features, works on (Y+16)/116 = y itself).
enum Plane : std::size_t { y_plane, cx_plane, cz_wide_plane, cz_narrow_plane, smooth_plane, edge_plane, point_plane };
constexpr std::size_t plane_count = 7;

struct Filtered {
  explicit Filtered(std::size_t pixels) {
    for (auto& plane : planes) plane.resize(pixels);
  }
  std::array<std::vector<float>, plane_count> planes;
};

/// How a source becomes display-referred in [0,1].
struct Display {
  bool hdr = false;
  float exposure_factor = 1;  ///< 2^exposure, HDR only
};

/// A row of `width` values with `radius` more at both ends, which repeat the border.
struct PaddedRow {
  PaddedRow(std::size_t w, std::size_t r) : values(w + 2 * r), width(w), radius(r) {}
  [[nodiscard]] float* data() { return values.data() + radius; }
  void repeat_border() {
    std::fill_n(values.begin(), radius, values[radius]);
    std::fill_n(values.end() - static_cast<std::ptrdiff_t>(radius), radius, values[radius + width - 1]);
  }
  std::vector<float> values;
  std::size_t width, radius;
};

void filter_horizontally(const Source& source, const Display& display, const Filters& filters, Filtered& out) {
  tbb::parallel_for(Rows(0, source.height, grain), [&](const Rows& range) {
    const std::size_t width = source.width;
    std::array<std::vector<float>, 3> rgb;
    for (auto& channel : rgb) channel.resize(width);
    PaddedRow y_row(width, filters.radius), cx_row(width, filters.radius), cz_row(width, filters.radius);
    const glm::mat3& m = flip::relative_xyz_from_rgb();
    for (std::size_t row = range.begin(); row < range.end(); ++row) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto line = source.rgb[c].subspan(row * width, width);
        if (display.hdr) {
          std::copy(line.begin(), line.end(), rgb[c].begin());
          flip::aces_row(rgb[c], display.exposure_factor);
        } else {
          std::transform(line.begin(), line.end(), rgb[c].begin(), [](float v) { return std::clamp(v, 0.f, 1.f); });
        }
      }
      float* const y = y_row.data();
      float* const cx = cx_row.data();
      float* const cz = cz_row.data();
      for (std::size_t x = 0; x < width; ++x) {
        const glm::vec3 n = m * glm::vec3(rgb[0][x], rgb[1][x], rgb[2][x]);
        y[x] = n.y;
        cx[x] = n.x - n.y;
        cz[x] = n.y - n.z;
      }
      for (PaddedRow* padded : {&y_row, &cx_row, &cz_row}) padded->repeat_border();
      const auto line = [&](Plane plane) { return std::span(out.planes[plane]).subspan(row * width, width); };
      const std::size_t r = filters.radius;
      flip::filter_even(line(y_plane), y_row.values, r, filters.achromatic);
      flip::filter_even(line(cx_plane), cx_row.values, r, filters.red_green);
      flip::filter_even(line(cz_wide_plane), cz_row.values, r, filters.blue_yellow[0]);
      flip::filter_even(line(cz_narrow_plane), cz_row.values, r, filters.blue_yellow[1]);
      flip::filter_even(line(smooth_plane), y_row.values, r, filters.gaussian);
      flip::filter_odd(line(edge_plane), y_row.values, r, filters.edge);
      flip::filter_even(line(point_plane), y_row.values, r, filters.point);
    }
  });
}

/// One row of one image after both filters.
struct FilteredRow {
  explicit FilteredRow(std::size_t width) {
    for (auto* row : {&y, &cx, &cz_wide, &cz_narrow, &edge_x, &edge_y, &point_x, &point_y}) row->resize(width);
  }
  void filter(const Filtered& image, const Filters& filters, std::size_t row) {
    const auto& p = image.planes;
    flip::filter_even_at_row(y, p[y_plane], row, filters.achromatic);
    flip::filter_even_at_row(cx, p[cx_plane], row, filters.red_green);
    flip::filter_even_at_row(cz_wide, p[cz_wide_plane], row, filters.blue_yellow[0]);
    flip::filter_even_at_row(cz_narrow, p[cz_narrow_plane], row, filters.blue_yellow[1]);
    flip::filter_even_at_row(edge_x, p[edge_plane], row, filters.gaussian);
    flip::filter_odd_at_row(edge_y, p[smooth_plane], row, filters.edge);
    flip::filter_even_at_row(point_x, p[point_plane], row, filters.gaussian);
    flip::filter_even_at_row(point_y, p[smooth_plane], row, filters.point);
  }
  /// Back to a colour that a display can show, then to the space in which differences are measured.
  [[nodiscard]] glm::vec3 lab(std::size_t x, const Filters& filters) const {
    const float cz = filters.blue_yellow_share[0] * cz_wide[x] + filters.blue_yellow_share[1] * cz_narrow[x];
    const glm::vec3 rgb = flip::rgb_from_relative_xyz() * glm::vec3(y[x] + cx[x], y[x], y[x] - cz);
    return flip::hunt_lab(flip::relative_xyz_from_rgb() * glm::clamp(rgb, 0.f, 1.f));
  }
  [[nodiscard]] float edge(std::size_t x) const { return std::sqrt(edge_x[x] * edge_x[x] + edge_y[x] * edge_y[x]); }
  [[nodiscard]] float point(std::size_t x) const {
    return std::sqrt(point_x[x] * point_x[x] + point_y[x] * point_y[x]);
  }
  std::vector<float> y, cx, cz_wide, cz_narrow, edge_x, edge_y, point_x, point_y;
};

/// ΔE = ΔEc^(1−ΔEf): a feature that is there in one image alone makes the difference of colour weigh more.
float pixel_error(const FilteredRow& a, const FilteredRow& reference, std::size_t x, const Filters& filters) {
  const float color = flip::redistribute(flip::hyab(a.lab(x, filters), reference.lab(x, filters)));
  const float edge = std::abs(a.edge(x) - reference.edge(x));
  const float point = std::abs(a.point(x) - reference.point(x));
  const float feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2_v<float>);
  return std::pow(color, 1 - std::min(feature, 1.f));
}

/// Raises `error` to the LDR-FLIP error of the two sources, shown as `display` says.
void raise_error(const Source& a, const Source& reference, const Display& display, const Filters& filters,
                 std::array<Filtered, 2>& storage, std::vector<float>& error) {
  filter_horizontally(a, display, filters, storage[0]);
  filter_horizontally(reference, display, filters, storage[1]);
  tbb::parallel_for(Rows(0, a.height, grain), [&](const Rows& range) {
    FilteredRow row_a(a.width), row_reference(a.width);
    for (std::size_t row = range.begin(); row < range.end(); ++row) {
      row_a.filter(storage[0], filters, row);
      row_reference.filter(storage[1], filters, row);
      float* const out = error.data() + row * a.width;
      for (std::size_t x = 0; x < a.width; ++x) {
        out[x] = std::max(out[x], pixel_error(row_a, row_reference, x, filters));
      }
    }
  });
}

void check(const Layer& a, const Layer& reference, double pixels_per_degree) {
  if (a.planes.size() != 3 || reference.planes.size() != 3) throw BadInput("FLIP compares images of three channels");
  if (a.width != reference.width || a.height != reference.height || a.pixels() == 0) {
    throw BadInput("FLIP compares images of one size");
  }
  // Beyond this the window is wider than any image; the bound keeps a slip of units from allocating it.
  constexpr double most = 1e4;
  if (!(pixels_per_degree > 0 && pixels_per_degree <= most)) throw BadInput("pixels per degree must be in (0, 1e4]");
  for (const auto plane : reference.planes) {
    if (!std::all_of(plane.begin(), plane.end(), [](float v) { return std::isfinite(v); })) {
      throw BadInput("the reference is not finite");
    }
  }
}

Source source_of(const Layer& layer) {
  return {.width = static_cast<std::size_t>(layer.width),
          .height = static_cast<std::size_t>(layer.height),
          .rgb = {layer.planes[0], layer.planes[1], layer.planes[2]}};
}

FlipMap flip_map(const Layer& a, const Layer& reference, double pixels_per_degree, std::span<const Display> displays) {
  check(a, reference, pixels_per_degree);
  const std::size_t pixels = a.pixels();
  const Source truth = source_of(reference);
  Source image = source_of(a);
  std::vector<std::size_t> holes;
  for (std::size_t i = 0; i < pixels; ++i) {
    const bool finite = std::all_of(image.rgb.begin(), image.rgb.end(), [i](auto p) { return std::isfinite(p[i]); });
    if (!finite) holes.push_back(i);
  }
  std::array<std::vector<float>, 3> filled;
  for (std::size_t c = 0; c < 3 && !holes.empty(); ++c) {
    filled[c].assign(image.rgb[c].begin(), image.rgb[c].end());
    for (const std::size_t i : holes) filled[c][i] = truth.rgb[c][i];
    image.rgb[c] = filled[c];
  }
  FlipMap map{.width = a.width, .height = a.height, .error = std::vector<float>(pixels), .mean = 0, .exposures = {}};
  const Filters filters(pixels_per_degree);
  std::array<Filtered, 2> storage{Filtered(pixels), Filtered(pixels)};
  for (const Display& display : displays) raise_error(image, truth, display, filters, storage, map.error);
  for (const std::size_t i : holes) map.error[i] = 1;
  double sum = 0;
  for (const float e : map.error) sum += static_cast<double>(e);
  map.mean = sum / static_cast<double>(pixels);
  return map;
}

}  // namespace

FlipMap flip_ldr(const Layer& a, const Layer& reference, double pixels_per_degree) {
  const Display display;
  return flip_map(a, reference, pixels_per_degree, std::span(&display, 1));
}

Exposures automatic_exposures(const Layer& reference) {
  constexpr glm::vec3 weights(.2126f, .7152f, .0722f);  // ITU-R BT.709
  std::vector<float> luminance(reference.pixels());
  for (std::size_t i = 0; i < luminance.size(); ++i) {
    const auto value = [&](std::size_t c) { return std::max(reference.planes[c][i], 0.f); };
    luminance[i] = glm::dot(weights, glm::vec3(value(0), value(1), value(2)));
  }
  // Where the image or most of it is black there is no finite exposure: this luminance stands in for 0.
  constexpr double darkest = std::numeric_limits<float>::epsilon();
  const double brightest =
      std::max(static_cast<double>(*std::max_element(luminance.begin(), luminance.end())), darkest);
  const auto middle = luminance.begin() + static_cast<std::ptrdiff_t>(luminance.size() / 2);
  std::nth_element(luminance.begin(), middle, luminance.end());
  const double median = std::max(static_cast<double>(*middle), darkest);
  constexpr double target = .85;  // HDR paper, section 3
  const double level = flip::aces_inverse(target);
  Exposures exposures{.start = std::log2(level / brightest), .stop = std::log2(level / median), .count = 2};
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

FlipMap flip_hdr(const Layer& a, const Layer& reference, double pixels_per_degree) {
  check(a, reference, pixels_per_degree);
  const Exposures exposures = automatic_exposures(reference);
  std::vector<Display> displays;
  displays.reserve(static_cast<std::size_t>(exposures.count));
  for (int i = 0; i < exposures.count; ++i) {
    const double exposure = exposures.start + (exposures.stop - exposures.start) * i / (exposures.count - 1);
    displays.push_back({.hdr = true, .exposure_factor = static_cast<float>(std::exp2(exposure))});
  }
  FlipMap map = flip_map(a, reference, pixels_per_degree, displays);
  map.exposures = exposures;
  return map;
}

}  // namespace loom::measure
