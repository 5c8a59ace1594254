// Projections with reversed depth in [0, 1]: near 1, far (perspective: infinity) 0.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "interop/camera.h"
#include "scene/gpu_scene.h"
#include "scene/scene.h"
#include "scene/world.h"

namespace loom::scene {
namespace {

struct Frame {
  glm::dvec3 right, up, forward;  // orthonormal
};

glm::dvec3 any_perpendicular(glm::dvec3 unit) {
  const glm::dvec3 axis = std::abs(unit.x) < .5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, -1);
  return glm::normalize(glm::cross(glm::cross(unit, axis), unit));
}

Frame frame_of(const Camera& camera) {
  Frame frame{};
  const glm::dvec3 towards = camera.target - camera.eye;
  const double distance = glm::length(towards);
  frame.forward = distance > 0 ? towards / distance : glm::dvec3(0, 0, -1);
  glm::dvec3 right = glm::cross(frame.forward, camera.up);
  // Looking along `up` leaves the roll open.
  const double sine = glm::length(right);
  if (!(sine > 1e-9 * glm::length(camera.up))) right = glm::cross(frame.forward, any_perpendicular(frame.forward));
  frame.right = glm::normalize(right);
  frame.up = glm::cross(frame.right, frame.forward);
  return frame;
}

glm::dmat4 view_of(const Frame& frame, glm::dvec3 eye) {
  glm::dmat4 view(1);
  for (glm::length_t i = 0; i < 3; ++i) {
    view[i] = {frame.right[i], frame.up[i], -frame.forward[i], 0};
  }
  view[3] = {-glm::dot(frame.right, eye), -glm::dot(frame.up, eye), glm::dot(frame.forward, eye), 1};
  return view;
}

/// Distance along `forward` from the eye to the farthest corner of the box.
double farthest(const Box& box, const Camera& camera, glm::dvec3 forward) {
  if (box.empty()) return 0;
  const glm::dvec3 corner = glm::mix(box.low, box.high, glm::greaterThan(forward, glm::dvec3(0)));
  return glm::dot(corner - camera.eye, forward);
}

}  // namespace

interop::Camera make_camera(const Camera& camera, const Box& box, glm::ivec2 size, glm::dvec2 jitter) {
  const Frame frame = frame_of(camera);
  const glm::dvec2 pixels(glm::max(size, glm::ivec2(1)));
  const double aspect = pixels.x / pixels.y;
  const glm::dvec2 shift = 2. * jitter / pixels;  // half-widths of the image plane

  glm::dvec2 half(1);  // of the image plane: at distance 1, orthographic in metres
  glm::dmat4 proj(0);
  if (camera.orthographic) {
    half = {camera.xmag > 0 ? camera.xmag : camera.ymag * aspect, camera.ymag};
    // Surfaces between the eye's plane and znear are cut, as glTF has it. A hundredth beyond the scene keeps the
    // farthest surface inside after rounding.
    const double near = std::max(camera.znear, 0.);
    const double reach = farthest(box, camera, frame.forward) - near;
    const double range = reach > 0 ? 1.01 * reach : 1;
    proj[0][0] = 1 / half.x;
    proj[1][1] = 1 / half.y;
    proj[2][2] = 1 / range;
    proj[3] = {-shift.x, -shift.y, 1 + near / range, 1};
  } else {
    half.y = std::tan(.5 * camera.yfov_rad);
    half.x = half.y * aspect;
    const double diagonal = box.diagonal();
    const double near = camera.znear > 0 ? camera.znear : 1e-4 * (diagonal > 0 ? diagonal : 1.);
    proj[0][0] = 1 / half.x;
    proj[1][1] = 1 / half.y;
    proj[2] = {shift.x, shift.y, 0, -1};
    proj[3][2] = near;
  }

  const glm::dmat4 view = view_of(frame, camera.eye);
  return {.view = glm::mat4(view),
          .proj = glm::mat4(proj),
          .view_proj = glm::mat4(proj * view),
          .eye = glm::vec4(glm::vec3(camera.eye), camera.orthographic ? 1.F : 0.F),
          .right = glm::vec4(glm::dvec4(half.x * frame.right, shift.x)),
          .up = glm::vec4(glm::dvec4(half.y * frame.up, shift.y)),
          .forward = glm::vec4(glm::dvec4(frame.forward, 0)),
          .size = glm::vec4(glm::dvec4(pixels, 1. / pixels))};
}

interop::Camera make_camera(const Camera& camera, const Scene& scene, glm::ivec2 size, glm::dvec2 jitter) {
  return make_camera(camera, world_box(scene), size, jitter);
}

}  // namespace loom::scene
