// The static facts of a scene that passes reflect on.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "interop/scene.h"
#include "scene/bounds.h"
#include "scene/emitters.h"
#include "scene/load.h"
#include "scene/motion.h"
#include "scene/sky.h"

namespace loom::scene {
namespace {

constexpr double narrow_spot_rad = 60 * 3.14159265358979323846 / 180;  // beyond it a spot takes six faces

double chroma(const glm::dvec3& c) {
  const double most = std::max({c.x, c.y, c.z});
  return most > 0 ? (most - std::min({c.x, c.y, c.z})) / most : 0;
}

/// The largest chroma that a product of two colours of these chromas can have: min/max ratios multiply at worst.
double chroma_of_product(double a, double b) { return 1 - (1 - a) * (1 - b); }

struct Reach {
  glm::dvec3 most{0};
  double chroma = 0;
};

const std::array<double, 256>& srgb_to_linear() {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double s = static_cast<double>(i) / 255;
      values[i] = s <= .04045 ? s / 12.92 : std::pow((s + .055) / 1.055, 2.4);
    }
    return values;
  }();
  return table;
}

/// Bounds of factor × texel over an sRGB image; filtering stays within them (the set of colours up to a chroma is
/// convex).
Reach reach_of(const glm::dvec3& factor, const Image& image) {
  const std::array<double, 256>& linear = srgb_to_linear();
  Reach reach;
  std::uint32_t last = 0;
  bool first = true;
  for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
    const std::uint32_t texel = image.rgba[i] | image.rgba[i + 1] << 8 | image.rgba[i + 2] << 16;
    if (!first && texel == last) continue;
    first = false;
    last = texel;
    const glm::dvec3 color =
        factor * glm::dvec3(linear[image.rgba[i]], linear[image.rgba[i + 1]], linear[image.rgba[i + 2]]);
    reach.most = glm::max(reach.most, color);
    reach.chroma = std::max(reach.chroma, chroma(color));
  }
  return reach;
}

Reach reach_of(const Scene& scene, const glm::dvec3& factor, const TextureRef& texture) {
  if (factor == glm::dvec3(0)) return {};
  if (texture.image < 0) return {factor, chroma(factor)};
  return reach_of(factor, scene.images[static_cast<std::size_t>(texture.image)]);
}

struct MaterialReach {
  Reach albedo, emission;
};

std::vector<MaterialReach> material_reaches(const Scene& scene) {
  std::vector<MaterialReach> reaches(scene.materials.size());
  oneapi::tbb::parallel_for(std::size_t{0}, reaches.size(), [&](std::size_t i) {
    const Material& m = scene.materials[i];
    // A metallic texture only takes diffuse albedo away, so the factor alone is the bound where there is none.
    const double diffuse = m.metallic_roughness_texture.image < 0 ? 1 - static_cast<double>(m.metallic) : 1.0;
    const bool ggx = scene.surfaces == SurfaceModel::ggx;
    const double opaque = ggx ? 1 - static_cast<double>(m.transmission) : 1;
    reaches[i].albedo = reach_of(scene, glm::dvec3(m.base_color) * (diffuse * opaque), m.base_color_texture);
    // The base colour of a metal, and of what is seen through a transparent surface, colours light too.
    if (ggx && m.glossy()) {
      reaches[i].albedo.chroma = reach_of(scene, glm::dvec3(m.base_color), m.base_color_texture).chroma;
    }
    reaches[i].emission = reach_of(scene, glm::dvec3(m.emissive), m.emissive_texture);
  });
  return reaches;
}

double vertex_chroma(const Primitive& p) {
  double most = 0;
  for (const glm::vec4& color : p.colors) most = std::max(most, chroma(glm::dvec3(color)));
  return most;
}

void count_lights(const Scene& scene, SceneFacts& facts) {
  for (const Light& light : scene.lights) {
    if (light.kind == LightKind::point) {
      ++facts.point_lights;
    } else if (light.kind == LightKind::directional) {
      ++facts.directional_lights;
    } else {
      ++(light.outer_rad > narrow_spot_rad ? facts.wide_spot_lights : facts.spot_lights);
    }
    facts.max_chroma = std::max(facts.max_chroma, chroma(glm::dvec3(light.intensity)));
  }
}

/// Emissive triangles of power, as light sources.
void add_emitters(const Scene& scene, SceneFacts& facts) {
  for (const interop::Emitter& emitter : build_emitters(scene)) {
    const double area = static_cast<double>(emitter.a.w) * (emitter.b.w > 0 ? 2 : 1);
    const glm::dvec3 radiance(emitter.radiance);
    facts.emissive_area += area;
    facts.emitted_power += std::numbers::pi * area * (radiance.r + radiance.g + radiance.b) / 3;
  }
}

/// Lights and cameras hang from nodes, as geometry does; a node moves with what is above it.
void find_motion(const Scene& scene, SceneFacts& facts) {
  std::vector<bool> moves(scene.nodes.size(), false);
  if (!scene.animations.empty())
    for (const Channel& channel : scene.animations.front().channels)
      if (!channel.times.empty()) moves[static_cast<std::size_t>(channel.node)] = true;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    if (node.parent >= 0 && moves[static_cast<std::size_t>(node.parent)]) moves[i] = true;
    facts.lights_move = facts.lights_move || (moves[i] && node.light >= 0);
    facts.camera_moves = facts.camera_moves || (moves[i] && node.camera >= 0);
  }
  facts.geometry_moves = facts.moving_triangles > 0;
  facts.moves = facts.geometry_moves || facts.lights_move;
}

void measure(const Scene& scene, SceneFacts& facts) {
  const Box all = swept_box(scene);
  if (all.empty()) return;
  const std::vector<Box> boxes = instance_boxes(scene);
  facts.bounds_min = all.low;
  facts.bounds_max = all.high;
  // A turned plane is not exactly flat: what is under a millionth of the scene counts as no extent.
  const double nothing = 1e-6 * glm::length(all.high - all.low);
  double thinnest = std::numeric_limits<double>::max();
  for (const Box& box : boxes) {
    if (box.empty()) continue;
    const glm::dvec3 extent = box.extent();
    for (int axis = 0; axis < 3; ++axis) {
      if (extent[axis] > nothing) thinnest = std::min(thinnest, extent[axis]);
    }
  }
  if (thinnest < std::numeric_limits<double>::max()) facts.thinnest_feature = thinnest;
}

}  // namespace

SceneFacts compute_facts(const Scene& scene) {
  SceneFacts facts;
  count_lights(scene, facts);
  facts.sky = scene.sky != glm::vec3(0);
  facts.ggx = scene.surfaces == SurfaceModel::ggx;
  facts.sky_image = facts.sky && scene.sky_image;
  facts.sky_bands = sky_bands(scene);
  facts.max_chroma = std::max(facts.max_chroma, chroma(glm::dvec3(scene.sky)));
  if (scene.sky_image) {
    for (const glm::vec3& radiance : scene.sky_image->radiance)
      facts.max_chroma = std::max(facts.max_chroma, chroma(glm::dvec3(radiance)));
  }
  const std::vector<MaterialReach> reaches = material_reaches(scene);
  std::vector<bool> used(scene.materials.size(), false);
  const std::vector<bool> moves = moving_instances(scene);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)].primitives) {
      const auto index = static_cast<std::size_t>(p.material);
      const MaterialReach& reach = reaches[index];
      const std::size_t triangles = p.indices.size() / 3;
      facts.triangles += triangles;
      if (moves[i]) facts.moving_triangles += triangles;
      used[index] = true;
      if (scene.materials[index].emissive != glm::vec3(0)) facts.emissive_triangles += static_cast<int>(triangles);
      facts.max_chroma = std::max(facts.max_chroma, chroma_of_product(reach.albedo.chroma, vertex_chroma(p)));
    }
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Material& m = scene.materials[i];
    facts.max_chroma = std::max(facts.max_chroma, reaches[i].emission.chroma);
    const glm::dvec3& most = reaches[i].albedo.most;
    facts.max_albedo = std::max({facts.max_albedo, most.x, most.y, most.z});
    const glm::dvec3& brightest = reaches[i].emission.most;
    facts.max_emission = std::max({facts.max_emission, brightest.x, brightest.y, brightest.z});
    facts.emissive_textures = facts.emissive_textures || m.emissive_texture.image >= 0;
    facts.alpha_mask = facts.alpha_mask || m.alpha == AlphaMode::mask;
    facts.normal_maps = facts.normal_maps || m.normal_texture.image >= 0;
    facts.specular = facts.specular || (facts.ggx && m.glossy());
    facts.transmission = facts.transmission || (facts.ggx && m.transmission > 0);
    facts.textures = facts.textures || m.base_color_texture.image >= 0 || m.metallic_roughness_texture.image >= 0 ||
                     m.normal_texture.image >= 0 || m.emissive_texture.image >= 0;
  }
  find_motion(scene, facts);
  if (facts.emissive_triangles > 0) add_emitters(scene, facts);
  measure(scene, facts);
  facts.content_hash = scene.content_hash;
  return facts;
}

}  // namespace loom::scene
