#include "scene/sky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

#include "loom/harmonics.h"
#include "scene/scene.h"

namespace loom::scene {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

glm::vec2 SkyImage::place_of(const glm::vec3& direction) {
  const float azimuth = direction.x == 0 && direction.z == 0 ? 0.F : std::atan2(direction.x, -direction.z);
  const float polar = std::acos(std::clamp(direction.y, -1.F, 1.F));
  return {azimuth / static_cast<float>(2 * pi) + .5F, polar / static_cast<float>(pi)};
}

glm::dvec3 SkyImage::direction_of(glm::dvec2 place) {
  const double azimuth = 2 * pi * (place.x - .5), polar = pi * place.y;
  return {std::sin(azimuth) * std::sin(polar), std::cos(polar), -std::cos(azimuth) * std::sin(polar)};
}

glm::vec3 SkyImage::at(const glm::vec3& direction) const {
  const glm::vec2 place = place_of(direction);
  float u = place.x + static_cast<float>(rotation_rad / (2 * pi));
  u -= std::floor(u);
  const float x = u * static_cast<float>(width) - .5F, y = place.y * static_cast<float>(height) - .5F;
  const float left = std::floor(x), top = std::floor(y), across = x - left, down = y - top;
  const auto column = [&](float of) { return (static_cast<int>(of) % width + width) % width; };
  const auto row = [&](float of) { return std::clamp(static_cast<int>(of), 0, height - 1); };
  const int x0 = column(left), x1 = column(left + 1), y0 = row(top), y1 = row(top + 1);
  return (1 - down) * ((1 - across) * texel(x0, y0) + across * texel(x1, y0)) +
         down * ((1 - across) * texel(x0, y1) + across * texel(x1, y1));
}

double SkyImage::solid_angle(int row) const {
  return 2 * pi / width * (std::cos(pi * row / height) - std::cos(pi * (row + 1) / height));
}

glm::vec3 SkyImage::mean() const {
  glm::dvec3 sum(0);
  for (int y = 0; y < height; ++y) {
    glm::dvec3 row(0);
    for (int x = 0; x < width; ++x) row += glm::dvec3(texel(x, y));
    sum += row * solid_angle(y);
  }
  return glm::vec3(sum / (4 * pi));
}

SkyImage SkyImage::halved() const {
  SkyImage half{.width = std::max(1, width / 2), .height = std::max(1, height / 2)};
  half.rotation_rad = rotation_rad;
  const auto overlap = [](double a0, double a1, double b0, double b1) {
    return std::max(0., std::min(a1, b1) - std::max(a0, b0));
  };
  const double wide = static_cast<double>(width) / half.width, high = static_cast<double>(height) / half.height;
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      glm::dvec3 sum(0);
      double weights = 0;
      for (int j = static_cast<int>(y * high); j < std::min<double>(height, (y + 1) * high); ++j) {
        // Of a row, the belt of the sphere between the two limits.
        const double above = std::max<double>(j, y * high), below = std::min<double>(j + 1, (y + 1) * high);
        const double belt = std::cos(pi * above / height) - std::cos(pi * below / height);
        for (int i = static_cast<int>(x * wide); i < std::min<double>(width, (x + 1) * wide); ++i) {
          const double weight = belt * overlap(i, i + 1, x * wide, (x + 1) * wide);
          sum += weight * glm::dvec3(texel(i, j));
          weights += weight;
        }
      }
      half.radiance.emplace_back(sum / weights);
    }
  }
  return half;
}

std::vector<glm::dvec3> SkyImage::harmonics(int order) const {
  // What a texel of .7 degrees averages over is far below the width of these bands.
  if (width > 512) return halved().harmonics(order);
  std::vector<glm::dvec3> result(static_cast<std::size_t>((order + 1) * (order + 1)), glm::dvec3(0));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto basis = loom::harmonics(direction_of({(x + .5) / width, (y + .5) / height}), order);
      const glm::dvec3 value = solid_angle(y) * glm::dvec3(texel(x, y));
      for (std::size_t i = 0; i < basis.size(); ++i) result[i] += basis[i] * value;
    }
  }
  return rotation_rad == 0 ? result : turned_about_y(result, rotation_rad);
}

void set_sky(Scene& scene, SkyImage image) {
  scene.sky = image.mean();
  scene.sky_image = std::make_shared<const SkyImage>(std::move(image));
}

glm::vec3 sky_radiance(const Scene& scene, const glm::vec3& direction) {
  return scene.sky_image ? scene.sky_image->at(direction) : scene.sky;
}

std::vector<glm::dvec3> sky_harmonics(const Scene& scene, int order) {
  if (scene.sky_image) return scene.sky_image->harmonics(order);
  std::vector<glm::dvec3> result(static_cast<std::size_t>((order + 1) * (order + 1)), glm::dvec3(0));
  result[0] = glm::dvec3(static_cast<float>(std::sqrt(4 * pi)) * scene.sky);
  return result;
}

std::array<double, 4> sky_bands(const Scene& scene) {
  if (!scene.sky_image) return {scene.sky == glm::vec3(0) ? 0. : 1., 0, 0, 0};
  const SkyImage& image = *scene.sky_image;
  const auto grey = [](const glm::dvec3& v) { return (v.x + v.y + v.z) / 3; };
  double square = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      square += image.solid_angle(y) * std::pow(grey(glm::dvec3(image.texel(x, y))), 2);
    }
  }
  std::array<double, 4> shares{};
  if (!(square > 0)) return shares;
  const std::vector<glm::dvec3> coefficients = image.harmonics(2);
  for (std::size_t l = 0; l < 3; ++l) {
    for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) shares.at(l) += std::pow(grey(coefficients[i]), 2) / square;
  }
  shares[3] = std::max(0., 1 - shares[0] - shares[1] - shares[2]);
  return shares;
}

std::string sky_json(const Scene& scene) {
  if (scene.sky_image) return scene.sky_image->source;
  const nlohmann::ordered_json constant{{"radiance", {scene.sky.x, scene.sky.y, scene.sky.z}}};
  return constant.dump();
}

void apply_sky(Scene& scene, const SkyChoice& choice, Diagnostics& diagnostics) {
  scene.sky_image = nullptr;
  if (choice.image.empty() && !choice.clear) {
    scene.sky = choice.radiance;
    return;
  }
  using Json = nlohmann::ordered_json;
  Json source;
  SkyImage image;
  if (choice.clear) {
    image = clear_sky(choice.sun, choice.turbidity);
    for (glm::vec3& value : image.radiance) value *= static_cast<float>(choice.scale);
    source = {{"model", "clear"},
              {"sun_direction", Json::array({choice.sun.x, choice.sun.y, choice.sun.z})},
              {"turbidity", choice.turbidity}};
  } else {
    image = read_sky(choice.image, choice.scale, choice.where, diagnostics);
    source = {{"image", std::filesystem::absolute(choice.image).string()}};
  }
  source["scale"] = choice.scale;
  source["rotation_deg"] = choice.rotation_deg;
  image.rotation_rad = choice.rotation_deg * pi / 180;
  image.source = source.dump();
  set_sky(scene, std::move(image));
}

}  // namespace loom::scene
