#include "reference/sky_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "loom/harmonics.h"
#include "scene/sky.h"

namespace loom::reference {
namespace {

constexpr double pi = std::numbers::pi;

float channels_mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3; }

/// The number of a cumulative list that u falls to; u becomes its place within, in [0,1).
int choose(const float* begin, const float* end, float& u) {
  const float* const found = std::upper_bound(begin, end, u);
  const auto i = std::min(found - begin, end - begin - 1);
  const float below = i == 0 ? 0 : begin[i - 1];
  const float width = begin[i] - below;
  u = width > 0 ? std::clamp((u - below) / width, 0.F, 0x1.fffffep-1F) : .5F;
  return static_cast<int>(i);
}

}  // namespace

SkySampler::SkySampler(const scene::Scene& scene) : scene_(scene) {
  if (!scene.sky_image || scene.sky == glm::vec3(0)) return;
  const scene::SkyImage& image = *scene.sky_image;
  const auto width = static_cast<std::size_t>(image.width);
  columns_.reserve(image.radiance.size());
  double total = 0;
  std::vector<double> totals;
  // The mean of a texel's own interpolated values: (1, 6, 1)/8 of its neighbours along each axis. It is above zero
  // wherever some of its directions shine, as the estimate's being unbiased asks for.
  const auto weight = [](int d) { return d == 0 ? .75F : .125F; };
  for (int y = 0; y < image.height; ++y) {
    double row = 0;
    for (int x = 0; x < image.width; ++x) {
      float value = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          value +=
              weight(i) * weight(j) *
              channels_mean(image.texel((x + i + image.width) % image.width, std::clamp(y + j, 0, image.height - 1)));
        }
      }
      row += value;
      columns_.push_back(static_cast<float>(row));
    }
    if (row > 0) {
      for (std::size_t x = 0; x < width; ++x)
        columns_[static_cast<std::size_t>(y) * width + x] /= static_cast<float>(row);
    }
    total += row * image.solid_angle(y);
    totals.push_back(total);
  }
  for (const double sum : totals) rows_.push_back(static_cast<float>(sum / total));
}

glm::vec3 SkySampler::radiance(const glm::vec3& direction) const { return scene::sky_radiance(scene_, direction); }

glm::vec3 SkySampler::sample(glm::vec2 u) const {
  const scene::SkyImage& image = *scene_.sky_image;
  const auto width = static_cast<std::size_t>(image.width);
  const int y = choose(rows_.data(), rows_.data() + rows_.size(), u.y);
  const float* const row = columns_.data() + static_cast<std::size_t>(y) * width;
  const int x = choose(row, row + width, u.x);
  const double above = std::cos(pi * y / image.height), below = std::cos(pi * (y + 1) / image.height);
  const double polar = std::acos(std::clamp(above + u.y * (below - above), -1., 1.));
  const glm::dvec3 local = scene::SkyImage::direction_of({(x + static_cast<double>(u.x)) / image.width, polar / pi});
  return glm::vec3(turned_about_y(local, image.rotation_rad));
}

float SkySampler::share(int x, int y) const {
  const auto width = static_cast<std::size_t>(scene_.sky_image->width);
  const auto at = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
  const float row = rows_[static_cast<std::size_t>(y)] - (y == 0 ? 0 : rows_[static_cast<std::size_t>(y) - 1]);
  return row * (columns_[at] - (x == 0 ? 0 : columns_[at - 1]));
}

float SkySampler::density(const glm::vec3& direction) const {
  const scene::SkyImage& image = *scene_.sky_image;
  const glm::vec2 place = scene::SkyImage::place_of(direction);
  float u = place.x + static_cast<float>(image.rotation_rad / (2 * pi));
  u -= std::floor(u);
  const int x = std::clamp(static_cast<int>(u * static_cast<float>(image.width)), 0, image.width - 1);
  const int y = std::clamp(static_cast<int>(place.y * static_cast<float>(image.height)), 0, image.height - 1);
  return share(x, y) / static_cast<float>(image.solid_angle(y));
}

}  // namespace loom::reference
