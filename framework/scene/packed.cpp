#include "scene/packed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "scene/motion.h"
#include "scene/world.h"

namespace loom::scene {
namespace {

/// Draws with equal keys bind the same textures.
auto texture_key(const Material& material) {
  const auto key = [](const TextureRef& ref) { return std::tuple(ref.image, ref.repeat_u, ref.repeat_v, ref.nearest); };
  return std::tuple(material.alpha == AlphaMode::mask, key(material.base_color_texture), key(material.normal_texture),
                    key(material.emissive_texture), key(material.metallic_roughness_texture));
}

glm::vec4 triangle_normal(const Primitive& primitive, std::size_t triangle) {
  const auto corner = [&](std::size_t k) {
    return glm::dvec3(primitive.positions[primitive.indices[3 * triangle + k]]);
  };
  const glm::dvec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const double length = glm::length(cross);
  return length > 0 ? glm::vec4(glm::dvec4(cross / length, 0)) : glm::vec4(0);
}

interop::Draw draw_record(const glm::dmat4& world, const PrimitiveRange& range, int material) {
  interop::Draw draw{};
  draw.world = glm::mat4(world);
  // Adjugate transpose = determinant × inverse transpose: it exists for singular transforms too. Its sign follows the
  // determinant, which the division takes out again; lengths do not matter, directions are normalised later.
  const glm::dmat3 m(world);
  glm::dmat3 normal(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  const bool mirrored = mirrors(world);
  double scale = 0;
  for (glm::length_t i = 0; i < 3; ++i) scale = std::max(scale, glm::length(normal[i]));
  if (scale > 0) normal *= (mirrored ? -1 : 1) / scale;
  draw.normal = glm::mat4(glm::dmat4(normal));
  draw.normal[3][3] = mirrored ? -1.F : 1.F;
  draw.material = {static_cast<std::uint32_t>(material), static_cast<std::uint32_t>(range.first_triangle),
                   mirrored ? 1U : 0U, 0U};
  return draw;
}

/// Ranges of every mesh that some instance shows; `range_of[mesh]` is its first.
void lay_out(const Scene& scene, Packed& packed, std::vector<std::size_t>& range_of) {
  constexpr auto unseen = static_cast<std::size_t>(-1);
  range_of.assign(scene.meshes.size(), unseen);
  std::size_t vertices = 0;
  std::size_t indices = 0;
  for (const Instance& instance : scene.instances) {
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    if (range_of[mesh] != unseen) continue;
    range_of[mesh] = packed.ranges.size();
    for (const Primitive& primitive : scene.meshes[mesh].primitives) {
      packed.ranges.push_back(
          {.primitive = &primitive, .first_vertex = vertices, .first_index = indices, .first_triangle = indices / 3});
      vertices += primitive.positions.size();
      indices += primitive.indices.size() / 3 * 3;
    }
  }
  packed.vertices.resize(vertices);
  packed.indices.resize(indices);
  packed.triangle_normals.resize(indices / 3);
}

void sort_into_batches(const Scene& scene, Packed& packed) {
  const auto material_of = [&](const DrawSource& draw) -> const Material& {
    return scene.materials[static_cast<std::size_t>(draw.material)];
  };
  const auto key = [&](const DrawSource& draw) { return std::tuple(texture_key(material_of(draw)), draw.moves); };
  std::stable_sort(packed.draws.begin(), packed.draws.end(),
                   [&](const DrawSource& a, const DrawSource& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < packed.draws.size(); ++i) {
    const DrawSource& draw = packed.draws[i];
    const PrimitiveRange& range = packed.ranges[draw.range];
    packed.commands.push_back({.count = static_cast<std::uint32_t>(range.primitive->indices.size() / 3 * 3),
                               .first_index = static_cast<std::uint32_t>(range.first_index),
                               .base_vertex = static_cast<std::int32_t>(range.first_vertex),
                               .base_instance = static_cast<std::uint32_t>(i)});
    if (i == 0 || key(packed.draws[i - 1]) != key(draw)) {
      packed.batches.push_back({.material = draw.material, .moves = draw.moves, .first = i});
    }
    ++packed.batches.back().count;
  }
}

}  // namespace

void pack_primitive(const PrimitiveRange& range, Packed& packed) {
  const Primitive& primitive = *range.primitive;
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
    const glm::vec2 uv0 = primitive.uv0.empty() ? glm::vec2(0) : primitive.uv0[i];
    const glm::vec2 uv1 = primitive.uv1.empty() ? glm::vec2(0) : primitive.uv1[i];
    packed.vertices[range.first_vertex + i] = {
        .position = primitive.positions[i],
        .normal = primitive.normals.empty() ? glm::vec3(0) : primitive.normals[i],
        .uv = glm::vec4(uv0, uv1),
        .color = primitive.colors.empty() ? glm::vec4(1) : primitive.colors[i],
        .tangent = primitive.tangents.empty() ? glm::vec4(0) : primitive.tangents[i]};
  }
  for (std::size_t i = 0; i < primitive.indices.size() / 3; ++i) {
    packed.triangle_normals[range.first_triangle + i] = triangle_normal(primitive, i);
  }
}

Packed pack(const Scene& scene) {
  Packed packed;
  std::vector<std::size_t> range_of;
  lay_out(scene, packed, range_of);
  for (const PrimitiveRange& range : packed.ranges) {
    pack_primitive(range, packed);
    std::copy_n(range.primitive->indices.begin(), range.primitive->indices.size() / 3 * 3,
                packed.indices.begin() + static_cast<std::ptrdiff_t>(range.first_index));
  }
  const std::vector<bool> moves = moving_instances(scene);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    for (std::size_t p = 0; p < scene.meshes[mesh].primitives.size(); ++p) {
      const Primitive& primitive = scene.meshes[mesh].primitives[p];
      if (primitive.indices.size() < 3) continue;
      packed.draws.push_back(
          {.instance = i, .range = range_of[mesh] + p, .material = primitive.material, .moves = moves[i]});
    }
  }
  sort_into_batches(scene, packed);
  return packed;
}

std::vector<interop::Draw> draw_records(const Scene& scene, const Packed& packed) {
  std::vector<interop::Draw> records;
  records.reserve(packed.draws.size());
  for (const DrawSource& draw : packed.draws) {
    records.push_back(draw_record(scene.instances[draw.instance].world, packed.ranges[draw.range], draw.material));
  }
  return records;
}

std::vector<interop::Light> light_records(const Scene& scene) {
  std::vector<interop::Light> records;
  int face = 0;
  for (const Light& light : scene.lights) {
    const bool spot = light.kind == LightKind::spot;
    const bool six = light.kind == LightKind::point || (spot && light.outer_rad > std::numbers::pi / 3);
    const int faces = six ? 6 : 1;
    const int kind = light.kind == LightKind::point ? LIGHT_POINT : spot ? LIGHT_SPOT : LIGHT_DIRECTIONAL;
    const double outer = std::cos(light.outer_rad);
    // KHR_lights_punctual: the floor of .001 keeps a cone without penumbra finite.
    const double slope = 1 / std::max(.001, std::cos(light.inner_rad) - outer);
    records.push_back({.position = glm::vec4(glm::dvec4(light.position, kind)),
                       .direction = glm::vec4(glm::dvec4(light.direction, face)),
                       .intensity = glm::vec4(light.intensity, faces),
                       .cone = spot ? glm::vec4(glm::dvec4(outer, slope, light.outer_rad, 0)) : glm::vec4(0)});
    face += faces;
  }
  return records;
}

}  // namespace loom::scene
