// A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999, appendix A.2:
//   F(θ,γ) = (1 + A·exp(B/cosθ))·(1 + C·exp(D·γ) + E·cos²γ)          (R. Perez et al. 1993)
//   Y = Y_z·F(θ,γ)/F(0,θ_s), and the chromaticities x and y likewise,
// θ being the angle from the zenith, γ that from the sun, θ_s that between both, and T the turbidity.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/sky.h"

namespace loom::scene {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double lumens_per_watt = 683;

struct Perez {
  double a, b, c, d, e;
  [[nodiscard]] double operator()(double cos_theta, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / cos_theta)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

/// (T², T, 1)·M·(θ_s³, θ_s², θ_s, 1)
double zenith_chromaticity(const std::array<std::array<double, 4>, 3>& m, double turbidity, double sun) {
  const auto row = [&](const std::array<double, 4>& r) { return ((r[0] * sun + r[1]) * sun + r[2]) * sun + r[3]; };
  return (row(m[0]) * turbidity + row(m[1])) * turbidity + row(m[2]);
}

}  // namespace

SkyImage clear_sky(const glm::dvec3& sun, double turbidity, int height) {
  const double t = turbidity, sun_angle = std::acos(std::clamp(sun.y, 0., 1.));
  const Perez luminance{.1787 * t - 1.4630, -.3554 * t + .4275, -.0227 * t + 5.3251, .1206 * t - 2.5771,
                        -.0670 * t + .3703};
  const Perez chroma_x{-.0193 * t - .2592, -.0665 * t + .0008, -.0004 * t + .2125, -.0641 * t - .8989,
                       -.0033 * t + .0452};
  const Perez chroma_y{-.0167 * t - .2608, -.0950 * t + .0092, -.0079 * t + .2102, -.0441 * t - 1.6537,
                       -.0109 * t + .0529};
  const double chi = (4. / 9 - t / 120) * (pi - 2 * sun_angle);
  const double zenith_y = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - .2155 * t + 2.4192);  // kcd/m² to cd/m²
  const double zenith_chroma_x = zenith_chromaticity(
      {{{.00166, -.00375, .00209, 0}, {-.02903, .06377, -.03202, .00394}, {.11693, -.21196, .06052, .25886}}}, t,
      sun_angle);
  const double zenith_chroma_y = zenith_chromaticity(
      {{{.00275, -.00610, .00317, 0}, {-.04214, .08970, -.04153, .00516}, {.15346, -.26756, .06670, .26688}}}, t,
      sun_angle);
  SkyImage image{.width = 2 * height, .height = height};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 w = SkyImage::direction_of({(x + .5) / image.width, (y + .5) / image.height});
      if (w.y <= 0) {
        image.radiance.emplace_back(0);
        continue;
      }
      const double gamma = std::acos(std::clamp(glm::dot(w, sun), -1., 1.));
      const auto of = [&](const Perez& f, double zenith) { return zenith * f(w.y, gamma) / f(1, sun_angle); };
      const double big_y = of(luminance, zenith_y) / lumens_per_watt;
      const double cx = of(chroma_x, zenith_chroma_x), cy = of(chroma_y, zenith_chroma_y);
      const double big_x = big_y * cx / cy, big_z = big_y * (1 - cx - cy) / cy;
      // CIE XYZ to linear Rec.709 (IEC 61966-2-1); what no such colour has is cut off.
      const glm::dvec3 rgb(3.2406 * big_x - 1.5372 * big_y - .4986 * big_z,
                           -.9689 * big_x + 1.8758 * big_y + .0415 * big_z,
                           .0557 * big_x - .2040 * big_y + 1.0570 * big_z);
      image.radiance.emplace_back(glm::max(rgb, glm::dvec3(0)));
    }
  }
  return image;
}

}  // namespace loom::scene
