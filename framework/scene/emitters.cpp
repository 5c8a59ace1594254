#include "scene/emitters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "scene/texture.h"
#include "scene/world.h"

namespace loom::scene {
namespace {

/// Longest side of a triangle on a texture, in texels.
double texels_across(const Scene& scene, const TextureRef& ref, const WorldTriangle& triangle) {
  const Image* image = image_of(scene, ref);
  if (image == nullptr) return 0;
  std::array<glm::vec2, 3> at{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec2 uv = ref.transform * glm::vec3(uv_of(*triangle.primitive, ref, triangle.vertices[k]), 1);
    at[k] = uv * glm::vec2(image->width, image->height);
  }
  const double longest =
      std::max({glm::distance(at[0], at[1]), glm::distance(at[1], at[2]), glm::distance(at[2], at[0])});
  return std::isfinite(longest) ? longest : 0;
}

template <class T>
T interpolate(const std::array<T, 3>& at, glm::vec3 weight) {
  return weight.x * at[0] + weight.y * at[1] + weight.z * at[2];
}

/// Radiance at a point of the triangle: emissive factor × texture, nothing where the mask cuts the surface away.
class Radiance {
 public:
  Radiance(const Scene& scene, const Material& material, const WorldTriangle& triangle)
      : material_(material), emissive_(image_of(scene, material.emissive_texture)) {
    const Primitive& primitive = *triangle.primitive;
    masked_ = material.alpha == AlphaMode::mask;
    if (masked_) base_ = image_of(scene, material.base_color_texture);
    for (std::size_t k = 0; k < 3; ++k) {
      emissive_uv_[k] = uv_of(primitive, material.emissive_texture, triangle.vertices[k]);
      base_uv_[k] = uv_of(primitive, material.base_color_texture, triangle.vertices[k]);
      alpha_[k] = material.base_color.a * (primitive.colors.empty() ? 1 : primitive.colors[triangle.vertices[k]].a);
    }
  }

  [[nodiscard]] glm::vec3 at(glm::vec3 weight) const {
    if (masked_) {
      float alpha = interpolate(alpha_, weight);
      if (base_ != nullptr) {
        alpha *= sample(*base_, material_.base_color_texture, Encoding::srgb, interpolate(base_uv_, weight)).a;
      }
      if (!(alpha >= material_.least_alpha())) return glm::vec3(0);
    }
    if (emissive_ == nullptr) return material_.emissive;
    const glm::vec4 texel =
        sample(*emissive_, material_.emissive_texture, Encoding::srgb, interpolate(emissive_uv_, weight));
    return material_.emissive * glm::vec3(texel);
  }

 private:
  const Material& material_;
  const Image* emissive_;
  const Image* base_ = nullptr;
  bool masked_ = false;
  std::array<glm::vec2, 3> emissive_uv_{}, base_uv_{};
  std::array<float, 3> alpha_{};
};

/// Mean over the area: the triangle is cut into n² congruent ones, and each is read at its centroid.
glm::vec3 mean_radiance(const Scene& scene, const Material& material, const WorldTriangle& triangle) {
  double texels = texels_across(scene, material.emissive_texture, triangle);
  if (material.alpha == AlphaMode::mask) {
    texels = std::max(texels, texels_across(scene, material.base_color_texture, triangle));
    // Vertex alpha can cut a triangle without any texture.
    if (!triangle.primitive->colors.empty()) texels = std::max(texels, 1.);
  }
  // Four look-ups across a texel; 256 bounds the work at 65,536 for a triangle that repeats its texture many times. An
  // edge in the texture leaves an error of at most 1/(2n) of the step.
  const int n = texels > 0 ? static_cast<int>(std::clamp(std::ceil(4 * texels), 16., 256.)) : 1;
  const Radiance radiance(scene, material, triangle);
  glm::dvec3 sum(0);
  const float third = 1.F / 3;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      const auto add = [&](float offset) {
        const float x = (static_cast<float>(i) + offset) / static_cast<float>(n);
        const float y = (static_cast<float>(j) + offset) / static_cast<float>(n);
        sum += glm::dvec3(radiance.at({1 - x - y, x, y}));
      };
      add(third);
      if (i + j + 1 < n) add(2 * third);
    }
  }
  return {sum / (static_cast<double>(n) * n)};
}

}  // namespace

std::vector<interop::Emitter> build_emitters(const Scene& scene) {
  std::vector<interop::Emitter> emitters;
  std::vector<double> powers;
  for_each_triangle(scene, [&](const WorldTriangle& triangle) {
    const Material& material = scene.materials[static_cast<std::size_t>(triangle.primitive->material)];
    if (!glm::any(glm::greaterThan(material.emissive, glm::vec3(0)))) return;
    const double area = .5 * glm::length(triangle.cross());
    if (!(area > 0)) return;
    const glm::vec3 radiance = mean_radiance(scene, material, triangle);
    // Up to the factor π that all share: the mean of the channels, so that each channel's error weighs the same.
    const double power = area * (material.double_sided ? 2 : 1) * (radiance.r + radiance.g + radiance.b) / 3;
    if (!(power > 0)) return;
    powers.push_back(power);
    emitters.push_back({.a = glm::vec4(glm::dvec4(triangle.corners[0], area)),
                        .b = glm::vec4(glm::dvec4(triangle.corners[1], material.double_sided ? 1 : 0)),
                        .c = glm::vec4(glm::dvec4(triangle.corners[2], 0)),
                        .radiance = glm::vec4(radiance, 0)});
  });
  double total = 0;
  for (const double power : powers) total += power;
  double sum = 0;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    sum += powers[i];
    emitters[i].c.w = i + 1 == emitters.size() ? 1.F : static_cast<float>(sum / total);
  }
  return emitters;
}

}  // namespace loom::scene
