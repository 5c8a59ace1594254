#include "scene/motion.h"

#include <algorithm>
#include <cstddef>

#include "scene/load.h"

namespace loom::scene {
namespace {

/// Steps from one key to the next: a part that turns by 90° between them leaves the hull of its poses by 2 % of its
/// reach.
constexpr std::size_t steps = 4;
constexpr std::size_t most_poses = 128;

std::vector<double> sample_times(const Animation& animation) {
  std::vector<double> keys;
  for (const Channel& channel : animation.channels) keys.insert(keys.end(), channel.times.begin(), channel.times.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<double> times;
  if (keys.empty()) return times;
  if ((keys.size() - 1) * steps < most_poses) {
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      for (std::size_t k = 0; k < steps; ++k)
        times.push_back(keys[i] + static_cast<double>(k) / steps * (keys[i + 1] - keys[i]));
    }
  } else {
    for (std::size_t k = 0; k + 1 < most_poses; ++k)
      times.push_back(keys.front() + static_cast<double>(k) / (most_poses - 1) * (keys.back() - keys.front()));
  }
  times.push_back(keys.back());
  return times;
}

/// The instances that move and what places them, without lights, cameras and pictures.
Scene moving_part(const Scene& scene, const std::vector<bool>& moves) {
  Scene part;
  part.nodes = scene.nodes;
  for (Node& node : part.nodes) node.light = node.camera = -1;
  part.skins = scene.skins;
  part.animations = scene.animations;
  part.meshes.resize(scene.meshes.size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (!moves[i]) continue;
    const auto mesh = static_cast<std::size_t>(scene.instances[i].mesh);
    part.instances.push_back(scene.instances[i]);
    part.meshes[mesh] = scene.meshes[mesh];
  }
  return part;
}

}  // namespace

bool is_animated(const Scene& scene) { return !scene.animations.empty() && !scene.animations.front().channels.empty(); }

std::vector<bool> moving_instances(const Scene& scene) {
  std::vector<bool> instances(scene.instances.size(), false);
  if (!is_animated(scene)) return instances;
  std::vector<bool> nodes(scene.nodes.size(), false);
  for (const Channel& channel : scene.animations.front().channels) nodes[static_cast<std::size_t>(channel.node)] = true;
  for (std::size_t i = 0; i < nodes.size(); ++i) {  // parents come before their children
    const int parent = scene.nodes[i].parent;
    if (parent >= 0 && nodes[static_cast<std::size_t>(parent)]) nodes[i] = true;
  }
  const auto moves = [&](int node) { return nodes[static_cast<std::size_t>(node)]; };
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const int node = scene.instances[i].node;
    const int skin = scene.nodes[static_cast<std::size_t>(node)].skin;
    if (skin < 0) {
      instances[i] = moves(node);
    } else {  // glTF: the joints alone place a skinned mesh
      const std::vector<int>& joints = scene.skins[static_cast<std::size_t>(skin)].joints;
      instances[i] = std::any_of(joints.begin(), joints.end(), moves);
    }
  }
  return instances;
}

Box swept_box(const Scene& scene) {
  Box all = scene_box(scene);
  const std::vector<bool> moves = moving_instances(scene);
  if (std::find(moves.begin(), moves.end(), true) == moves.end()) return all;
  Scene part = moving_part(scene, moves);
  for (const double time : sample_times(scene.animations.front())) {
    pose(part, time);
    const Box box = scene_box(part);
    if (box.empty()) continue;
    all.add(box.low);
    all.add(box.high);
  }
  return all;
}

}  // namespace loom::scene
