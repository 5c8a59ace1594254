#include "viewer/camera_control.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace loom::viewer {
namespace {

struct Axes {
  glm::dvec3 right, up, forward;
};

Axes axes_of(const scene::Camera& camera) {
  const glm::dvec3 towards = camera.target - camera.eye;
  const double length = glm::length(towards);
  const glm::dvec3 forward = length > 0 ? towards / length : glm::dvec3(0, 0, -1);
  glm::dvec3 right = glm::cross(forward, camera.up);
  if (!(glm::length(right) > 1e-9)) right = glm::cross(forward, glm::dvec3(forward.y, forward.z, forward.x));
  right = glm::normalize(right);
  return {right, glm::cross(right, forward), forward};
}

/// `forward` turned about the camera's up and right; it stops short of the poles, where right would jump.
glm::dvec3 turned(const scene::Camera& camera, glm::dvec2 turn) {
  const Axes axes = axes_of(camera);
  const glm::dvec3 pole = glm::normalize(camera.up);
  constexpr double margin = .01;  // radians
  const double elevation = std::asin(std::clamp(glm::dot(axes.forward, pole), -1., 1.));
  const double limit = 1.5707963267948966 - margin;
  const double up = std::clamp(elevation + turn.y, -limit, limit) - elevation;
  const glm::dvec3 tilted = glm::angleAxis(up, axes.right) * axes.forward;
  return glm::normalize(glm::angleAxis(-turn.x, pole) * tilted);
}

}  // namespace

void aim_at_scene(scene::Camera& camera, const scene::Box& box) {
  if (box.empty()) return;
  const glm::dvec3 forward = axes_of(camera).forward;
  const double ahead = glm::dot(box.centre() - camera.eye, forward);
  camera.target = camera.eye + forward * std::max(ahead, .05 * std::max(box.diagonal(), 1e-3));
}

void orbit(scene::Camera& camera, glm::dvec2 turn) {
  const double distance = glm::length(camera.target - camera.eye);
  camera.eye = camera.target - distance * turned(camera, turn);
}

void look(scene::Camera& camera, glm::dvec2 turn) {
  const double distance = glm::length(camera.target - camera.eye);
  camera.target = camera.eye + distance * turned(camera, turn);
}

void pan(scene::Camera& camera, glm::dvec2 share) {
  const Axes axes = axes_of(camera);
  const double height = camera.orthographic
                            ? 2 * camera.ymag
                            : 2 * std::tan(.5 * camera.yfov_rad) * glm::length(camera.target - camera.eye);
  const glm::dvec3 shift = height * (share.x * axes.right + share.y * axes.up);
  camera.eye += shift;
  camera.target += shift;
}

void zoom(scene::Camera& camera, double factor) {
  if (camera.orthographic) {
    camera.ymag *= factor;
    camera.xmag *= factor;
    return;
  }
  camera.eye = camera.target + factor * (camera.eye - camera.target);
}

void fly(scene::Camera& camera, const glm::dvec3& distance) {
  const Axes axes = axes_of(camera);
  const glm::dvec3 shift = distance.x * axes.right + distance.y * axes.up + distance.z * axes.forward;
  camera.eye += shift;
  camera.target += shift;
}

}  // namespace loom::viewer
