#include "scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/gtc/type_ptr.hpp>

#include "scene/gltf/accessor.h"

namespace loom::scene::gltf {
namespace {

constexpr double half_pi = 1.5707963267948966;

struct Counts {
  std::size_t meshes, skins, cameras, lights;
};

Counts count_things(const Value& root) {
  const std::optional<Value> lights = root.extension("KHR_lights_punctual");
  return {root.items("meshes").size(), root.items("skins").size(), root.items("cameras").size(),
          lights ? lights->items("lights").size() : 0};
}

glm::dvec3 to_vec3(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Node read_node(Document& document, const Value& value) {
  Node node;
  node.name = value.text("name");
  const std::vector<double> matrix = value.numbers("matrix", 16);
  if (!matrix.empty()) {
    if (value.has("translation") || value.has("rotation") || value.has("scale")) {
      document.warn("gltf-node", "has a matrix and translation, rotation or scale: the matrix counts", value.pointer());
    }
    if (matrix[3] != 0 || matrix[7] != 0 || matrix[11] != 0 || matrix[15] != 1) {
      value.fail("gltf-range", "its matrix is not affine: the last row must be 0 0 0 1");
    }
    node.matrix = glm::make_mat4(matrix.data());
    return node;
  }
  node.translation = to_vec3(value.numbers<3>("translation", {0, 0, 0}));
  node.scale = to_vec3(value.numbers<3>("scale", {1, 1, 1}));
  const auto r = value.numbers<4>("rotation", {0, 0, 0, 1});
  const glm::dquat rotation(r[3], r[0], r[1], r[2]);
  const double length = glm::length(rotation);
  if (!(length > 0) || !std::isfinite(length)) value.fail("gltf-range", "its rotation has no length");
  if (std::abs(length - 1) > 1e-3)
    document.warn("gltf-node", "its rotation is no unit quaternion and is normalised", value.pointer());
  node.rotation = rotation / length;
  return node;
}

NodeUse read_use(const Value& value, const Counts& counts) {
  NodeUse use;
  use.pointer = value.pointer();
  use.mesh = value.index("mesh", counts.meshes, "meshes");
  use.skin = value.index("skin", counts.skins, "skins");
  use.camera = value.index("camera", counts.cameras, "cameras");
  if (const std::optional<Value> light = value.extension("KHR_lights_punctual")) {
    use.light = light->required_index("light", counts.lights, "lights");
  }
  return use;
}

/// Parent of every node, in the file's own numbers.
std::vector<int> read_parents(const std::vector<Value>& values) {
  std::vector<int> parents(values.size(), -1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const Value& child : values[i].items("children")) {
      int& parent = parents[static_cast<std::size_t>(child.as_index(values.size(), "nodes"))];
      if (parent >= 0) child.fail("gltf-node", "has two parents, or is named twice");
      parent = static_cast<int>(i);
    }
  }
  return parents;
}

/// An order in which parents come before children.
std::vector<int> order_of(Document& document, const std::vector<int>& parents) {
  std::vector<int> order;
  std::vector<std::vector<int>> children(parents.size());
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] < 0) {
      order.push_back(static_cast<int>(i));
    } else {
      children[static_cast<std::size_t>(parents[i])].push_back(static_cast<int>(i));
    }
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<int>& next = children[static_cast<std::size_t>(order[i])];
    order.insert(order.end(), next.begin(), next.end());
  }
  // With one parent each, whatever no root leads to is a loop.
  if (order.size() != parents.size()) document.fail("/nodes", "gltf-node", "some node is its own ancestor");
  return order;
}

/// Roots of what is drawn: the default scene, else the first, else every root.
std::vector<int> scene_roots(Document& document, const std::vector<int>& parents) {
  const std::vector<Value> scenes = document.root().items("scenes");
  std::vector<int> roots;
  if (scenes.empty()) {
    for (std::size_t i = 0; i < parents.size(); ++i) {
      if (parents[i] < 0) roots.push_back(static_cast<int>(i));
    }
    if (!roots.empty()) document.warn("gltf-scene", "the file has no scene, so all its nodes are drawn");
    return roots;
  }
  const int chosen = std::max(0, document.root().index("scene", scenes.size(), "scenes"));
  for (const Value& node : scenes[static_cast<std::size_t>(chosen)].items("nodes")) {
    const int root = node.as_index(parents.size(), "nodes");
    if (parents[static_cast<std::size_t>(root)] >= 0) {
      document.warn("gltf-node", "is listed as a root of the scene, but has a parent", node.pointer());
    }
    roots.push_back(root);
  }
  return roots;
}

std::size_t components_of(Path path) { return path == Path::rotation ? 4 : 3; }

std::optional<Channel> read_channel(Document& document, const Value& value, const std::vector<Value>& samplers,
                                    const NodeTree& tree) {
  const Value& sampler =
      samplers[static_cast<std::size_t>(value.required_index("sampler", samplers.size(), "samplers"))];
  const Value target = value.require("target");
  const int node = target.index("node", tree.place.size(), "nodes");
  const std::string path = target.text("path");
  Channel channel;
  if (path == "translation") {
    channel.path = Path::translation;
  } else if (path == "rotation") {
    channel.path = Path::rotation;
  } else if (path == "scale") {
    channel.path = Path::scale;
  } else {
    document.warn("gltf-animation", "animates \"" + path + "\", which stays as it is", target.pointer());
    return std::nullopt;
  }
  if (node < 0) return std::nullopt;
  channel.node = tree.place[static_cast<std::size_t>(node)];
  if (tree.nodes[static_cast<std::size_t>(channel.node)].matrix) {
    document.warn("gltf-animation", "animates a node that has a matrix, which stays as it is", target.pointer());
    return std::nullopt;
  }
  const std::string interpolation = sampler.text("interpolation", "LINEAR");
  if (interpolation == "STEP") {
    channel.interpolation = Interpolation::step;
  } else if (interpolation == "CUBICSPLINE") {
    channel.interpolation = Interpolation::cubic;
  } else if (interpolation != "LINEAR") {
    sampler.fail("gltf-range", "its interpolation \"" + interpolation + "\" is unknown");
  }
  const int input = sampler.required_index("input", document.accessors().size(), "accessors");
  const int output = sampler.required_index("output", document.accessors().size(), "accessors");
  if (document.accessors()[static_cast<std::size_t>(input)].components != 1)
    sampler.fail("gltf-type", "its input must be scalar");
  channel.times = read_floats(document, input, sampler.pointer());
  for (std::size_t i = 0; i < channel.times.size(); ++i) {
    if (!std::isfinite(channel.times[i]) || (i > 0 && channel.times[i] <= channel.times[i - 1])) {
      sampler.fail("gltf-animation", "its times must be finite and rise");
    }
  }
  const Accessor& values = document.accessors()[static_cast<std::size_t>(output)];
  const std::size_t components = components_of(channel.path);
  const std::size_t keys = channel.times.size() * (channel.interpolation == Interpolation::cubic ? 3 : 1);
  if (static_cast<std::size_t>(values.components) != components || values.count != keys) {
    sampler.fail("gltf-animation", "its output must hold " + std::to_string(keys) + " values of " +
                                       std::to_string(components) + " components");
  }
  const std::vector<float> numbers = read_floats(document, output, sampler.pointer());
  channel.values.resize(keys, glm::vec4(0));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!std::isfinite(numbers[i])) sampler.fail("gltf-animation", "its output holds a number that is not finite");
    channel.values[i / components][static_cast<int>(i % components)] = numbers[i];
  }
  return channel;
}

}  // namespace

NodeTree read_nodes(Document& document) {
  const std::vector<Value> values = document.root().items("nodes");
  const Counts counts = count_things(document.root());
  const std::vector<int> parents = read_parents(values);
  const std::vector<int> order = order_of(document, parents);
  NodeTree tree;
  tree.place.assign(values.size(), -1);
  for (const int i : order) {
    tree.place[static_cast<std::size_t>(i)] = static_cast<int>(tree.nodes.size());
    const Value& value = values[static_cast<std::size_t>(i)];
    Node node = read_node(document, value);
    const int parent = parents[static_cast<std::size_t>(i)];
    if (parent >= 0) node.parent = tree.place[static_cast<std::size_t>(parent)];
    tree.nodes.push_back(std::move(node));
    tree.uses.push_back(read_use(value, counts));
  }
  std::vector<bool> in_scene(tree.nodes.size(), false);
  std::vector<bool> hidden(tree.nodes.size(), false);
  for (const int root : scene_roots(document, parents)) {
    in_scene[static_cast<std::size_t>(tree.place[static_cast<std::size_t>(root)])] = true;
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const std::optional<Value> visibility = values[static_cast<std::size_t>(order[i])].extension("KHR_node_visibility");
    hidden[i] = visibility && !visibility->flag("visible", true);
    if (tree.nodes[i].parent >= 0) {
      const auto parent = static_cast<std::size_t>(tree.nodes[i].parent);
      hidden[i] = hidden[i] || hidden[parent];
      in_scene[i] = in_scene[i] || in_scene[parent];
    }
    tree.uses[i].shown = in_scene[i] && !hidden[i];
  }
  return tree;
}

std::vector<Skin> read_skins(Document& document, const NodeTree& tree) {
  std::vector<Skin> skins;
  for (const Value& value : document.root().items("skins")) {
    Skin skin;
    for (const Value& joint : value.items("joints")) {
      skin.joints.push_back(tree.place[static_cast<std::size_t>(joint.as_index(tree.place.size(), "nodes"))]);
    }
    if (skin.joints.empty()) value.fail("gltf-missing", "has no joints");
    if (value.has("skeleton")) (void)value.required_index("skeleton", tree.place.size(), "nodes");
    const int matrices = value.index("inverseBindMatrices", document.accessors().size(), "accessors");
    skin.inverse_bind.assign(skin.joints.size(), glm::dmat4(1));
    if (matrices >= 0) {
      const Accessor& accessor = document.accessors()[static_cast<std::size_t>(matrices)];
      if (accessor.components != 16 || accessor.component_type != 5126 || accessor.count < skin.joints.size()) {
        value.fail("gltf-type", "needs " + std::to_string(skin.joints.size()) + " float MAT4 inverse bind matrices");
      }
      const std::vector<float> numbers = read_floats(document, matrices, value.pointer());
      for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        for (std::size_t c = 0; c < 16; ++c) {
          const float number = numbers[j * 16 + c];
          if (!std::isfinite(number)) value.fail("gltf-range", "an inverse bind matrix is not finite");
          skin.inverse_bind[j][static_cast<int>(c / 4)][static_cast<int>(c % 4)] = static_cast<double>(number);
        }
      }
    }
    skins.push_back(std::move(skin));
  }
  return skins;
}

std::vector<Animation> read_animations(Document& document, const NodeTree& tree) {
  std::vector<Animation> animations;
  for (const Value& value : document.root().items("animations")) {
    Animation animation;
    animation.name = value.text("name");
    const std::vector<Value> samplers = value.items("samplers");
    for (const Value& channel : value.items("channels")) {
      if (std::optional<Channel> read = read_channel(document, channel, samplers, tree)) {
        animation.channels.push_back(std::move(*read));
      }
    }
    animations.push_back(std::move(animation));
  }
  if (animations.size() > 1)
    document.note("gltf-animation", "only the first of " + std::to_string(animations.size()) + " animations is played");
  return animations;
}

std::vector<Light> read_lights(Document& document) {
  std::vector<Light> lights;
  const std::optional<Value> extension = document.root().extension("KHR_lights_punctual");
  if (!extension) return lights;
  for (const Value& value : extension->items("lights")) {
    Light light;
    light.name = value.text("name");
    const std::string type = value.text("type");
    if (type == "point") {
      light.kind = LightKind::point;
    } else if (type == "spot") {
      light.kind = LightKind::spot;
    } else if (type == "directional") {
      light.kind = LightKind::directional;
    } else {
      value.fail("gltf-range", type.empty() ? "has no type" : "its type \"" + type + "\" is unknown");
    }
    const glm::dvec3 color = to_vec3(value.numbers<3>("color", {1, 1, 1}));
    if (glm::any(glm::lessThan(color, glm::dvec3(0)))) value.fail("gltf-range", "its colour is negative");
    light.intensity = glm::vec3(color * value.number("intensity", 1, 0));
    if (light.kind == LightKind::spot) {
      const Value cone = value.require("spot");
      light.inner_rad = cone.number("innerConeAngle", 0, 0, half_pi);
      light.outer_rad = cone.number("outerConeAngle", half_pi / 2, 0, half_pi + 1e-6);
      if (light.inner_rad >= light.outer_rad)
        cone.fail("gltf-range", "its inner cone must be narrower than the outer one");
    }
    lights.push_back(light);
  }
  return lights;
}

std::vector<Camera> read_cameras(Document& document) {
  std::vector<Camera> cameras;
  for (const Value& value : document.root().items("cameras")) {
    Camera camera;
    camera.name = value.text("name");
    const std::string type = value.text("type");
    if (type == "perspective") {
      const Value lens = value.require("perspective");
      camera.yfov_rad = lens.number("yfov", std::nullopt, 1e-6, 2 * half_pi - 1e-6);
      camera.znear = lens.number("znear", std::nullopt, 0);
    } else if (type == "orthographic") {
      const Value lens = value.require("orthographic");
      camera.orthographic = true;
      camera.xmag = std::abs(lens.number("xmag", std::nullopt));
      camera.ymag = std::abs(lens.number("ymag", std::nullopt));
      camera.znear = lens.number("znear", std::nullopt, 0);
      if (camera.xmag == 0 || camera.ymag == 0) lens.fail("gltf-range", "its xmag and ymag must not be 0");
    } else {
      value.fail("gltf-range", type.empty() ? "has no type" : "its type \"" + type + "\" is unknown");
    }
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace loom::scene::gltf
