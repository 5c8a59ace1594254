#include "scene/bvh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include <embree3/rtcore.h>
#include <embree3/rtcore_builder.h>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/diagnostic.h"
#include "scene/texture.h"
#include "scene/world.h"

namespace loom::scene {
namespace {

/// Triangles a leaf holds at most; trace.glsl has four bits for the number.
constexpr unsigned int leaf_triangles = 4;

interop::BvhTriangle triangle_of(const Scene& scene, const WorldTriangle& world) {
  const Primitive& primitive = *world.primitive;
  const TextureRef& texture = scene.materials[static_cast<std::size_t>(primitive.material)].base_color_texture;
  std::array<glm::vec2, 3> uv{};
  std::array<float, 3> alpha{};
  for (std::size_t k = 0; k < 3; ++k) {
    uv[k] = texture.transform * glm::vec3(uv_of(primitive, texture, world.vertices[k]), 1);
    alpha[k] = primitive.colors.empty() ? 1.F : primitive.colors[world.vertices[k]].a;
  }
  return {.a = glm::vec4(glm::vec3(world.corners[0]), std::bit_cast<float>(primitive.material)),
          .b = glm::vec4(glm::vec3(world.corners[1]), alpha[0]),
          .c = glm::vec4(glm::vec3(world.corners[2]), alpha[1]),
          .uv_ab = glm::vec4(uv[0], uv[1]),
          .uv_c = glm::vec4(uv[2], alpha[2], 0)};
}

/// As Embree's callbacks make them; memory belongs to the RTCBVH.
struct BuildNode {
  std::array<RTCBounds, 2> bounds{};
  std::array<BuildNode*, 2> children{};
  std::uint32_t first = 0, count = 0;  ///< leaf: range of BuildState::order, else 0
};

struct BuildState {
  std::vector<std::uint32_t> order;  ///< triangle of each place in the leaves
  std::atomic<std::uint32_t> used{0};
};

static_assert(std::is_trivially_destructible_v<BuildNode>, "Embree frees the memory without running destructors");

BuildNode* make_node(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), alignof(BuildNode))) BuildNode;
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned int /*children*/, void* /*state*/) {
  return make_node(allocator);
}

void set_children(void* node, void** children, unsigned int count, void* /*state*/) {
  for (unsigned int i = 0; i < count; ++i)
    static_cast<BuildNode*>(node)->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned int count, void* /*state*/) {
  for (unsigned int i = 0; i < count; ++i) static_cast<BuildNode*>(node)->bounds[i] = *bounds[i];
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count,
                  void* user) {
  auto& state = *static_cast<BuildState*>(user);
  BuildNode* leaf = make_node(allocator);
  leaf->count = static_cast<std::uint32_t>(count);
  leaf->first = state.used.fetch_add(leaf->count);
  for (std::size_t i = 0; i < count; ++i) state.order[leaf->first + i] = primitives[i].primID;
  return leaf;
}

struct Releaser {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Releaser>;

std::string embree_error(RTCDevice device) {
  return "the BVH could not be built: Embree error " + std::to_string(static_cast<int>(rtcGetDeviceError(device)));
}

RTCBuildPrimitive build_primitive(const interop::BvhTriangle& triangle, std::uint32_t index) {
  const glm::vec3 a(triangle.a);
  const glm::vec3 b(triangle.b);
  const glm::vec3 c(triangle.c);
  const glm::vec3 lower = glm::min(a, glm::min(b, c));
  const glm::vec3 upper = glm::max(a, glm::max(b, c));
  return {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, index};
}

/// Embree's tree laid out for the shader: depth first, siblings adjacent, triangles in the order of the leaves. So the
/// result does not depend on the order in which the builder's threads made their leaves.
void flatten(const BuildNode& root, const BuildState& state, const std::vector<interop::BvhTriangle>& source,
             Bvh& bvh) {
  struct Open {
    const BuildNode* node;
    std::size_t at;
    int depth;
  };
  std::vector<Open> open{{&root, 0, 1}};
  while (!open.empty()) {
    const Open next = open.back();
    open.pop_back();
    bvh.depth = std::max(bvh.depth, next.depth);
    const BuildNode& node = *next.node;
    const bool leaf = node.count > 0;
    const std::size_t first = leaf ? bvh.triangles.size() : bvh.nodes.size();
    bvh.nodes[next.at].lower.w = std::bit_cast<float>(static_cast<std::uint32_t>(first));
    bvh.nodes[next.at].upper.w = std::bit_cast<float>(node.count);
    for (std::uint32_t i = 0; i < node.count; ++i) bvh.triangles.push_back(source[state.order[node.first + i]]);
    if (leaf) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      const RTCBounds& b = node.bounds[i];
      bvh.nodes.push_back(
          {.lower = {b.lower_x, b.lower_y, b.lower_z, 0}, .upper = {b.upper_x, b.upper_y, b.upper_z, 0}});
    }
    open.push_back({node.children[1], first + 1, next.depth + 1});
    open.push_back({node.children[0], first, next.depth + 1});
  }
}

}  // namespace

Bvh build_bvh(const Scene& scene) {
  std::vector<interop::BvhTriangle> triangles;
  for_each_triangle(scene, [&](const WorldTriangle& world) {
    if (world.cross() != glm::dvec3(0)) triangles.push_back(triangle_of(scene, world));
  });
  Bvh bvh;
  if (triangles.empty()) return bvh;
  if (triangles.size() >= std::size_t{1} << 27) {
    // Twice as many nodes, in the 28 bits that trace.glsl has for them.
    throw Error("the scene has " + std::to_string(triangles.size()) + " triangles; ray queries can hold 134 million");
  }

  std::vector<RTCBuildPrimitive> primitives;
  primitives.reserve(triangles.size());
  Box world;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    primitives.push_back(build_primitive(triangles[i], i));
    const RTCBuildPrimitive& p = primitives.back();
    world.add({p.lower_x, p.lower_y, p.lower_z});
    world.add({p.upper_x, p.upper_y, p.upper_z});
  }

  const Owned<RTCDevice> device(rtcNewDevice(nullptr));
  if (!device) throw Error(embree_error(nullptr));
  const Owned<RTCBVH> tree(rtcNewBVH(device.get()));
  BuildState state;
  state.order.resize(triangles.size());
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = 2;
  // The last eight of these levels the builder only halves by number, so that it ends in time.
  arguments.maxDepth = BVH_STACK;
  arguments.maxLeafSize = leaf_triangles;
  arguments.bvh = tree.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  arguments.userPtr = &state;
  const auto* root = static_cast<const BuildNode*>(rtcBuildBVH(&arguments));
  if (root == nullptr) throw Error(embree_error(device.get()));

  bvh.nodes.reserve(2 * triangles.size());
  bvh.triangles.reserve(triangles.size());
  bvh.nodes.push_back({.lower = glm::vec4(glm::dvec4(world.low, 0)), .upper = glm::vec4(glm::dvec4(world.high, 0))});
  flatten(*root, state, triangles, bvh);
  if (bvh.depth > BVH_STACK) throw Error("the BVH is deeper than the shaders' stack");
  return bvh;
}

}  // namespace loom::scene
