#include "viewer/light_gizmo.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

namespace loom::viewer {
namespace {

constexpr double arm_share = .18;  ///< length of an arm, in heights of the picture at the light's distance
constexpr double turner = 1.35;    ///< of the arm that turns, in arms: it may lie along one of the others

glm::dvec3 axis_of(HandleKind kind) {
  return kind == HandleKind::axis_x   ? glm::dvec3(1, 0, 0)
         : kind == HandleKind::axis_y ? glm::dvec3(0, 1, 0)
                                      : glm::dvec3(0, 0, 1);
}

glm::dvec3 eye(const ScreenView& view) { return glm::dvec3(view.camera.eye); }
glm::dvec3 forward(const ScreenView& view) { return glm::dvec3(view.camera.forward); }
bool orthographic(const ScreenView& view) { return view.camera.eye.w > .5F; }

double arm_length(const ScreenView& view, const glm::dvec3& centre) {
  const double half = glm::length(glm::dvec3(view.camera.up));
  const double depth = orthographic(view) ? 1 : std::abs(glm::dot(centre - eye(view), forward(view)));
  return arm_share * 2 * half * std::max(depth, 1e-6);
}

/// Where the ray meets the plane through the point and parallel to the image.
std::optional<glm::dvec3> on_plane(const ScreenView& view, const Ray& ray, const glm::dvec3& point) {
  const double along = glm::dot(ray.direction, forward(view));
  if (along < 1e-9) return std::nullopt;
  return ray.origin + ray.direction * (glm::dot(point - ray.origin, forward(view)) / along);
}

/// How far along the axis the point nearest to the ray lies; nothing where the two are nearly parallel.
std::optional<double> along_axis(const Ray& ray, const glm::dvec3& centre, const glm::dvec3& axis) {
  const double c = glm::dot(axis, ray.direction), sine2 = 1 - c * c;
  if (sine2 < 1e-4) return std::nullopt;
  const glm::dvec3 gap = ray.origin - centre;
  return (glm::dot(gap, axis) - c * glm::dot(gap, ray.direction)) / sine2;
}

/// From the centre to the point of the sphere that the ray meets first, or passes nearest; unit.
std::optional<glm::dvec3> on_sphere(const Ray& ray, const glm::dvec3& centre, double radius, bool behind) {
  const glm::dvec3 gap = ray.origin - centre;
  const double b = glm::dot(gap, ray.direction), c = glm::dot(gap, gap) - radius * radius;
  const double root = std::sqrt(std::max(b * b - c, 0.));
  const glm::dvec3 at = gap + ray.direction * (behind ? -b + root : -b - root);
  if (glm::length(at) < 1e-12) return std::nullopt;
  return glm::normalize(at);
}

}  // namespace

std::optional<glm::vec2> on_screen(const ScreenView& view, const glm::dvec3& point) {
  const glm::dvec4 clip = glm::dmat4(view.camera.view_proj) * glm::dvec4(point, 1);
  if (!(clip.w > 1e-9)) return std::nullopt;
  const glm::dvec2 ndc = glm::dvec2(clip) / clip.w;
  if (!(std::abs(ndc.x) < 1e4 && std::abs(ndc.y) < 1e4)) return std::nullopt;
  return view.corner + view.size * glm::vec2(.5 * ndc.x + .5, .5 - .5 * ndc.y);
}

Ray ray_through(const ScreenView& view, glm::vec2 at) {
  const glm::dvec2 share = glm::dvec2(at - view.corner) / glm::dvec2(view.size);
  const glm::dvec2 s(2 * share.x - 1, 1 - 2 * share.y);
  const glm::dvec3 across = s.x * glm::dvec3(view.camera.right) + s.y * glm::dvec3(view.camera.up);
  if (orthographic(view)) return {eye(view) + across, forward(view)};
  return {eye(view), glm::normalize(forward(view) + across)};
}

glm::dvec3 handle_centre(const scene::Light& light, const scene::Box& box) {
  return light.kind == scene::LightKind::directional ? box.centre() : light.position;
}

std::vector<Handle> handles_of(const ScreenView& view, const scene::Light& light, const scene::Box& box) {
  const glm::dvec3 centre = handle_centre(light, box);
  const std::optional<glm::vec2> middle = on_screen(view, centre);
  if (!middle) return {};
  std::vector<Handle> handles = {{HandleKind::centre, *middle, *middle}};
  const double arm = arm_length(view, centre);
  const auto seen = [&](glm::vec2 at) {
    return glm::all(glm::greaterThanEqual(at, view.corner)) && glm::all(glm::lessThan(at, view.corner + view.size));
  };
  const auto add = [&](HandleKind kind, const glm::dvec3& way) {
    if (const auto at = on_screen(view, centre + arm * way)) handles.push_back({kind, *at, *middle});
  };
  if (light.kind != scene::LightKind::directional) {
    for (const HandleKind kind : {HandleKind::axis_x, HandleKind::axis_y, HandleKind::axis_z}) {
      // An arm that would leave the picture stands on the other side.
      const auto tip = on_screen(view, centre + arm * axis_of(kind));
      add(kind, tip && seen(*tip) ? axis_of(kind) : -axis_of(kind));
    }
  }
  if (light.kind != scene::LightKind::point) add(HandleKind::direction, turner * light.direction);
  return handles;
}

std::optional<scene::Light> dragged_light(const ScreenView& view, const scene::Light& light, const scene::Box& box,
                                          HandleKind kind, glm::vec2 from, glm::vec2 to) {
  scene::Light result = light;
  const glm::dvec3 centre = handle_centre(light, box);
  const Ray before = ray_through(view, from), after = ray_through(view, to);
  if (kind == HandleKind::direction) {
    // The side of the sphere on which the handle is, so that it follows the pointer.
    const bool behind = glm::dot(light.direction, forward(view)) > 0;
    const auto way = on_sphere(after, centre, turner * arm_length(view, centre), behind);
    if (!way) return std::nullopt;
    result.direction = *way;
    return result;
  }
  if (light.kind == scene::LightKind::directional) return std::nullopt;
  if (kind == HandleKind::centre) {
    const auto a = on_plane(view, before, centre), b = on_plane(view, after, centre);
    if (!a || !b) return std::nullopt;
    result.position += *b - *a;
    return result;
  }
  const auto a = along_axis(before, centre, axis_of(kind)), b = along_axis(after, centre, axis_of(kind));
  if (!a || !b) return std::nullopt;
  // An axis that points into the picture may be dragged to infinity.
  const double far = 10 * std::max(box.diagonal(), 1e-3);
  result.position += axis_of(kind) * glm::clamp(*b - *a, -far, far);
  return result;
}

}  // namespace loom::viewer
