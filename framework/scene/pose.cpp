// Where everything is at a time: animation channels, node matrices, lights, cameras, instances, skins.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "scene/load.h"

namespace loom::scene {
namespace {

glm::dquat to_quat(const glm::dvec4& v) { return {v.w, v.x, v.y, v.z}; }
glm::dvec4 to_vec4(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

/// The channel's value at `time`, held at its ends (glTF 2.0, appendix C).
glm::dvec4 sample(const Channel& channel, double time) {
  const std::vector<float>& times = channel.times;
  const bool cubic = channel.interpolation == Interpolation::cubic;
  const auto key = [&](std::size_t i) { return glm::dvec4(channel.values[cubic ? 3 * i + 1 : i]); };
  if (time <= static_cast<double>(times.front())) return key(0);
  if (time >= static_cast<double>(times.back())) return key(times.size() - 1);
  const auto after = static_cast<std::size_t>(
      std::upper_bound(times.begin(), times.end(), time, [](double t, float k) { return t < static_cast<double>(k); }) -
      times.begin());
  const std::size_t before = after - 1;
  const double length = static_cast<double>(times[after]) - static_cast<double>(times[before]);
  const double t = (time - static_cast<double>(times[before])) / length;
  if (channel.interpolation == Interpolation::step) return key(before);
  if (!cubic) {
    if (channel.path != Path::rotation) return glm::mix(key(before), key(after), t);
    return to_vec4(glm::slerp(glm::normalize(to_quat(key(before))), glm::normalize(to_quat(key(after))), t));
  }
  const glm::dvec4 out_tangent(channel.values[3 * before + 2]);
  const glm::dvec4 in_tangent(channel.values[3 * after]);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * key(before) + length * (t3 - 2 * t2 + t) * out_tangent +
         (3 * t2 - 2 * t3) * key(after) + length * (t3 - t2) * in_tangent;
}

void animate(Scene& scene, double time) {
  if (scene.animations.empty()) return;
  for (const Channel& channel : scene.animations.front().channels) {
    if (channel.times.empty()) continue;
    Node& node = scene.nodes[static_cast<std::size_t>(channel.node)];
    const glm::dvec4 value = sample(channel, time);
    if (channel.path == Path::translation) {
      node.translation = glm::dvec3(value);
    } else if (channel.path == Path::scale) {
      node.scale = glm::dvec3(value);
    } else if (const double length = glm::length(value); length > 0) {
      node.rotation = to_quat(value / length);
    }
  }
}

glm::dmat4 local_matrix(const Node& node) {
  if (node.matrix) return *node.matrix;
  glm::dmat4 matrix = glm::mat4_cast(node.rotation);
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= node.scale[axis];
  matrix[3] = glm::dvec4(node.translation, 1);
  return matrix;
}

glm::dvec3 direction_or(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : fallback;
}

template <class T>
bool assign(T& target, const T& value) {
  if (target == value) return false;
  target = value;
  return true;
}

bool move_light(Light& light, const glm::dmat4& world) {
  const bool moved = assign(light.position, glm::dvec3(world[3]));
  return assign(light.direction, direction_or(-glm::dvec3(world[2]), {0, 0, -1})) || moved;
}

bool move_camera(Camera& camera, const glm::dmat4& world) {
  const glm::dvec3 eye(world[3]);
  const bool moved = assign(camera.eye, eye);
  const bool turned = assign(camera.target, eye + direction_or(-glm::dvec3(world[2]), {0, 0, -1}));
  return assign(camera.up, direction_or(glm::dvec3(world[1]), {0, 1, 0})) || moved || turned;
}

/// The matrices of a skin's joints, relative to `anchor`, so that vertices far from the origin keep their digits.
std::vector<glm::mat4> joint_matrices(const Scene& scene, const Skin& skin, const glm::dvec3& anchor) {
  std::vector<glm::mat4> matrices;
  matrices.reserve(skin.joints.size());
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    glm::dmat4 matrix = scene.nodes[static_cast<std::size_t>(skin.joints[j])].world * skin.inverse_bind[j];
    matrix[3] -= glm::dvec4(anchor, 0);
    matrices.emplace_back(matrix);
  }
  return matrices;
}

glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& fallback) {
  const float length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : fallback;
}

/// Cofactors: the inverse transpose but for a factor, and defined where a joint is scaled to nothing.
glm::mat3 normal_matrix(const glm::mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

void skin_vertices(Primitive& p, const std::vector<glm::mat4>& joints) {
  using Range = oneapi::tbb::blocked_range<std::size_t>;
  constexpr std::size_t grain = 2048;
  oneapi::tbb::parallel_for(Range(0, p.rest_positions.size(), grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      glm::mat4 matrix(0);
      for (int c = 0; c < 4; ++c) {
        if (p.weights[i][c] > 0) matrix += p.weights[i][c] * joints[p.joints[i][c]];
      }
      const glm::mat3 linear(matrix);
      p.positions[i] = glm::vec3(matrix * glm::vec4(p.rest_positions[i], 1));
      p.normals[i] = unit_or(normal_matrix(linear) * p.rest_normals[i], p.rest_normals[i]);
      if (!p.rest_tangents.empty()) {
        const glm::vec3 rest(p.rest_tangents[i]);
        p.tangents[i] = glm::vec4(unit_or(linear * rest, rest), p.rest_tangents[i].w);
      }
    }
  });
}

bool is_skinned(const Primitive& p) { return !p.rest_positions.empty(); }

}  // namespace

bool pose(Scene& scene, double time_s) {
  animate(scene, time_s);
  bool moved = false;
  for (Node& node : scene.nodes) {
    const glm::dmat4 parent = node.parent < 0 ? glm::translate(glm::dmat4(1), -scene.origin)
                                              : scene.nodes[static_cast<std::size_t>(node.parent)].world;
    moved = assign(node.world, parent * local_matrix(node)) || moved;
  }
  for (const Node& node : scene.nodes) {
    if (node.light >= 0) moved = move_light(scene.lights[static_cast<std::size_t>(node.light)], node.world) || moved;
    if (node.camera >= 0)
      moved = move_camera(scene.cameras[static_cast<std::size_t>(node.camera)], node.world) || moved;
  }
  for (Instance& instance : scene.instances) {
    const Node& node = scene.nodes[static_cast<std::size_t>(instance.node)];
    if (node.skin < 0) {
      moved = assign(instance.world, node.world) || moved;
      continue;
    }
    // glTF: the joints alone place a skinned mesh, its node's own matrix is ignored.
    const Skin& skin = scene.skins[static_cast<std::size_t>(node.skin)];
    const glm::dvec3 anchor(scene.nodes[static_cast<std::size_t>(skin.joints.front())].world[3]);
    const std::vector<glm::mat4> joints = joint_matrices(scene, skin, anchor);
    moved = assign(instance.world, glm::translate(glm::dmat4(1), anchor)) || moved;
    for (Primitive& primitive : scene.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
      if (!is_skinned(primitive)) continue;
      skin_vertices(primitive, joints);
    }
  }
  return moved;
}

}  // namespace loom::scene
