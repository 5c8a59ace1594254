#include "measure/stress_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "scene/content_hash.h"
#include "scene/geometry.h"
#include "scene/load.h"
#include "scene/world.h"

namespace loom::measure {
namespace {

constexpr double pi = std::numbers::pi;

/// Positions are given in the room's own metres and placed by scale, turn and offset, in double: the instance's matrix
/// carries the offset, as a glTF node does.
class Builder {
 public:
  explicit Builder(const Room& room) : unit_(room.unit), turns_(room.quarter_turns), offset_(room.offset) {
    scene_.path = "a stress scene";
  }

  int material(glm::vec3 albedo, glm::vec3 radiance = glm::vec3(0)) {
    scene::Material material;
    material.base_color = glm::vec4(albedo, 1);
    material.emissive = radiance;
    scene_.materials.push_back(material);
    return static_cast<int>(scene_.materials.size()) - 1;
  }

  /// Counter-clockwise corners, three a triangle; mended as a file's would be.
  void triangles(std::vector<glm::vec3> corners, int material, std::vector<glm::vec3> normals = {}) {
    scene::Primitive primitive;
    primitive.material = material;
    primitive.normals = std::move(normals);
    for (const glm::vec3& corner : corners) {
      primitive.indices.push_back(static_cast<std::uint32_t>(primitive.positions.size()));
      primitive.positions.push_back(glm::vec3(unit_ * turned(glm::dvec3(corner))));
    }
    for (glm::vec3& normal : primitive.normals) normal = glm::vec3(turned(glm::dvec3(normal)));
    scene::repair(primitive);
    if (primitive.indices.empty()) return;
    glm::dmat4 world(1);
    world[3] = glm::dvec4(offset_, 1);
    const int mesh = static_cast<int>(scene_.meshes.size());
    scene_.meshes.push_back({.name = "", .primitives = {std::move(primitive)}});
    scene::Node node;
    node.matrix = world;
    node.world = world;
    node.mesh = mesh;
    scene_.instances.push_back({.mesh = mesh, .node = static_cast<int>(scene_.nodes.size()), .world = world});
    scene_.nodes.push_back(node);
  }

  void quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int material) {
    triangles({a, b, c, a, c, d}, material);
  }

  /// Six faces; towards the inside where `inward`. What stands on a floor needs no bottom: which of two surfaces in one
  /// place a ray meets, the last bit of its length decides. `front`: the face towards +z.
  void box(glm::vec3 low, glm::vec3 high, int material, bool inward = false, bool bottom = true, bool front = true) {
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3;
      const int j = (axis + 2) % 3;
      for (const bool upper : {false, true}) {
        if ((axis == 1 && !upper && !bottom) || (axis == 2 && upper && !front)) continue;
        glm::vec3 a = low;
        a[axis] = upper ? high[axis] : low[axis];
        glm::vec3 b = a;
        b[i] = high[i];
        glm::vec3 c = b;
        c[j] = high[j];
        glm::vec3 d = a;
        d[j] = high[j];
        if (upper != inward) {
          quad(a, b, c, d, material);
        } else {
          quad(a, d, c, b, material);
        }
      }
    }
  }

  /// Intensity in the room's own units: scaled along, it lights the same.
  void point(glm::dvec3 position, float intensity) {
    scene::Light light;
    light.position = placed(position);
    light.intensity = glm::vec3(static_cast<float>(intensity * unit_ * unit_));
    scene_.lights.push_back(light);
  }

  View look(glm::dvec3 eye, glm::dvec3 target, bool orthographic) {
    scene::Camera camera;
    camera.eye = placed(eye);
    camera.target = placed(target);
    camera.yfov_rad = 1;
    camera.orthographic = orthographic;
    camera.xmag = camera.ymag = unit_;
    camera.znear = 1e-3 * unit_;
    scene::recentre(scene_);
    camera.eye -= scene_.origin;
    camera.target -= scene_.origin;
    scene_.content_hash = scene::content_hash(scene_);
    return {std::move(scene_), camera};
  }

  scene::Scene& scene() { return scene_; }

 private:
  [[nodiscard]] glm::dvec3 turned(glm::dvec3 p) const {
    for (int i = 0; i < turns_; ++i) p = {p.z, p.y, -p.x};
    return p;
  }
  [[nodiscard]] glm::dvec3 placed(glm::dvec3 p) const { return unit_ * turned(p) + offset_; }

  double unit_;
  int turns_;
  glm::dvec3 offset_;
  scene::Scene scene_;
};

// No symmetry: what lies exactly on an edge of a texel or a cell is decided by the last bit of a float. In a square
// room probes would look straight into its corners.
constexpr glm::vec3 room_low(-1.97f, 0, -2.06f), room_high(1.66f, 2.93f, 1.94f);
// With a colour: grey alone would take other programs.
constexpr glm::vec3 clay(.8f, .7f, .6f);
constexpr glm::dvec3 eye(.3, 1.6, 1.7), target(-.1, 1.1, -1);

/// The room's shell and block, or only what `add` makes of it, lit by one lamp.
View odd(const std::function<void(Builder&)>& add, bool shell = true) {
  Builder builder{Room{}};
  if (shell) builder.box(room_low, room_high, builder.material({.6f, .5f, .4f}), true);
  builder.point({.7, 2.3, .4}, 3);
  add(builder);
  return builder.look(eye, target, false);
}

/// Distance from a point to a triangle: to its plane where the foot lies inside, else to the nearest edge.
double distance_to(const glm::dvec3& p, const scene::WorldTriangle& triangle) {
  const auto& [a, b, c] = triangle.corners;
  const glm::dvec3 cross = triangle.cross();
  const double length = glm::length(cross);
  if (length > 0) {
    const glm::dvec3 n = cross / length;
    const glm::dvec3 foot = p - glm::dot(p - a, n) * n;
    const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
      return glm::dot(glm::cross(to - from, foot - from), n) >= 0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a)) return std::abs(glm::dot(p - a, n));
  }
  const auto to_edge = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 edge = to - from;
    const double square = glm::dot(edge, edge);
    const double t = square > 0 ? glm::clamp(glm::dot(p - from, edge) / square, 0., 1.) : 0;
    return glm::length(p - from - t * edge);
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

View make_room(const Room& room) {
  Builder builder(room);
  const int walls = builder.material(glm::vec3(room.albedo));
  const int tinted = builder.material(room.albedo * glm::vec3(1, .4f, .2f));
  builder.box(room_low, room_high, walls, true, true, !room.open);
  builder.scene().sky = glm::vec3(room.sky);
  builder.box({-1.3f, 0, -1.2f}, {-.4f, 1.1f, -.3f}, tinted, false, false);
  if (room.divider > 0) {
    const auto half = static_cast<float>(.5 * room.divider);
    builder.box({room_low.x, room_low.y, -.7f - half}, {room_high.x, room_high.y, -.7f + half}, walls);
  }
  if (room.lamp >= 0) {
    const int lamp = builder.material(glm::vec3(0), glm::vec3(room.lamp));
    builder.quad({-.5f, 2.9f, -.5f}, {.5f, 2.9f, -.5f}, {.5f, 2.9f, .5f}, {-.5f, 2.9f, .5f}, lamp);
  }
  for (int i = 0; i < room.lights; ++i) {
    const double angle = .4 + 2 * pi * i / std::max(room.lights, 1);
    builder.point({.9 * std::cos(angle) + room.light_step, 2.1, .9 * std::sin(angle)}, room.intensity);
  }
  return builder.look(eye, target, room.orthographic);
}

std::vector<NamedView> odd_scenes() {
  const auto with = [](std::function<void(Builder&)> add, bool shell = true) {
    return [add = std::move(add), shell] { return odd(add, shell); };
  };
  const auto room = [](const Room& r) { return [r] { return make_room(r); }; };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  return {
      {"empty scene", with([](Builder&) {}, false)},
      {"empty scene, no light", with([](Builder& b) { b.scene().lights.clear(); }, false)},
      {"empty scene under a sky", with([](Builder& b) { b.scene().sky = glm::vec3(1); }, false)},
      {"black scene", room({.albedo = 0, .intensity = 0})},
      {"no light", room({.lights = 0})},
      {"one triangle", with(
                           [](Builder& b) {
                             b.triangles({{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}}, b.material(clay));
                           },
                           false)},
      {"flat scene", with(
                         [](Builder& b) {
                           b.quad({-2, 1, 2}, {2, 1, 2}, {2, 1, -2}, {-2, 1, -2}, b.material(clay));
                         },
                         false)},
      {"zero-area triangles", with([](Builder& b) {
         b.triangles({{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {.5f, 1, .5f}, {.5f, 1, .5f}, {.5f, 1, .5f}},
                     b.material(clay, glm::vec3(5)));
       })},
      {"needles", with([](Builder& b) {
         const int material = b.material(clay, glm::vec3(2));
         for (int i = 0; i < 16; ++i) {
           const float x = -1.5f + .2f * static_cast<float>(i);
           b.triangles({{x, .2f, -1}, {x + 1e-6f, .2f, -1}, {x, 2.8f, -1.1f}}, material);
         }
       })},
      {"duplicate triangles", with([](Builder& b) {
         const int material = b.material(clay, glm::vec3(1));
         for (int i = 0; i < 8; ++i) b.quad({-1, 1, 0}, {1, 1, 0}, {1, 1, -1}, {-1, 1, -1}, material);
       })},
      {"NaN and infinite corners", with([nan, infinity](Builder& b) {
         const int material = b.material(clay, glm::vec3(1));
         b.triangles({{nan, 1, 0}, {1, 1, 0}, {0, 2, 0}, {0, 1, 0}, {infinity, 1, 0}, {0, 2, 0}}, material);
         b.triangles({{-1, .5f, 0}, {0, .5f, 0}, {0, 1.5f, 0}}, material);
       })},
      {"normals of no length", with([nan](Builder& b) {
         b.triangles({{-1, .5f, 0}, {0, .5f, 0}, {0, 1.5f, 0}}, b.material(clay),
                     {glm::vec3(0), glm::vec3(nan), glm::vec3(0, 0, 1e-30f)});
       })},
      {"light inside a wall", with([](Builder& b) {
         const int wall = b.material(clay);
         b.box({room_low.x, room_low.y, -.8f}, {room_high.x, room_high.y, -.6f}, wall);
         b.point({0, 1.5, -.7}, 20);
       })},
      {"light on a wall", with([](Builder& b) {
         b.point({0, 1, room_low.z}, 5);
       })},
      {"light at the camera", with([](Builder& b) { b.point(eye, 5); })},
      {"light far away", with([](Builder& b) {
         b.point({0, 1e6, 0}, 1e8f);
       })},
      {"black sky, bright lamp", room({.lights = 0, .lamp = 1e8f})},
      {"a lamp and a light of nothing", room({.intensity = 0, .lamp = 1})},
      {"1 W/sr beside 1e8", with([](Builder& b) {
         b.point({-1, 2, -1}, 1e8f);
       })},
      {"albedo 0", room({.albedo = 0, .lamp = 2})},
      {"albedo 1", room({.albedo = 1, .lamp = 2})},
  };
}

double furnace_bound(const scene::Scene& scene) {
  double emission = std::max({scene.sky.x, scene.sky.y, scene.sky.z});
  double albedo = 0;
  std::vector<double> nearest(scene.lights.size(), std::numeric_limits<double>::infinity());
  scene::for_each_triangle(scene, [&](const scene::WorldTriangle& triangle) {
    const scene::Material& m = scene.materials[static_cast<std::size_t>(triangle.primitive->material)];
    for (int c = 0; c < 3; ++c) {
      emission = std::max(emission, static_cast<double>(m.emissive[c]));
      albedo = std::max(albedo, static_cast<double>(m.base_color[c] * (1 - m.metallic)));
    }
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      nearest[i] = std::min(nearest[i], distance_to(scene.lights[i].position, triangle));
    }
  });
  double irradiance = 0;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const scene::Light& light = scene.lights[i];
    const double strongest = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    if (strongest == 0) continue;
    irradiance += light.kind == scene::LightKind::directional ? strongest : strongest / (nearest[i] * nearest[i]);
  }
  const double straight = emission + albedo / pi * irradiance;
  return straight == 0 ? 0 : straight / std::max(1 - albedo, 0.);
}

}  // namespace loom::measure
