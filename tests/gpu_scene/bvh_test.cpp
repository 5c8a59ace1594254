#include "scene/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>

#include "interop/scene.h"
#include "scene/scene.h"
#include "support/hand_scene.h"

namespace loom::scene {
namespace {

using test::empty_scene;
using test::place;
using test::quad;
using test::random_triangles;

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

/// Every node encloses what hangs below it, every triangle hangs once, siblings are where the shader looks for them.
void check(const Bvh& bvh, std::size_t triangles) {
  ASSERT_FALSE(bvh.nodes.empty());
  ASSERT_EQ(bvh.triangles.size(), triangles);
  EXPECT_LE(bvh.depth, BVH_STACK);
  std::vector<int> seen(triangles);
  std::vector<int> visited(bvh.nodes.size());
  std::vector<std::uint32_t> open{0};
  const auto inside = [](const interop::BvhNode& outer, glm::vec3 low, glm::vec3 high) {
    return glm::all(glm::lessThanEqual(glm::vec3(outer.lower), low)) &&
           glm::all(glm::greaterThanEqual(glm::vec3(outer.upper), high));
  };
  while (!open.empty()) {
    const interop::BvhNode& node = bvh.nodes[open.back()];
    ++visited[open.back()];
    open.pop_back();
    const std::uint32_t first = bits(node.lower.w);
    const std::uint32_t count = bits(node.upper.w);
    ASSERT_LE(count, 15U);  // four bits in trace.glsl
    for (std::uint32_t i = first; i < first + count; ++i) {
      ASSERT_LT(i, triangles);
      ++seen[i];
      const glm::vec3 a(bvh.triangles[i].a);
      const glm::vec3 b(bvh.triangles[i].b);
      const glm::vec3 c(bvh.triangles[i].c);
      EXPECT_TRUE(inside(node, glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))));
    }
    if (count > 0) continue;
    for (std::uint32_t child = first; child < first + 2; ++child) {
      ASSERT_LT(child, bvh.nodes.size());
      EXPECT_TRUE(inside(node, glm::vec3(bvh.nodes[child].lower), glm::vec3(bvh.nodes[child].upper)));
      open.push_back(child);
    }
  }
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
  EXPECT_TRUE(std::all_of(visited.begin(), visited.end(), [](int n) { return n == 1; }));
}

TEST(Bvh, HoldsEveryTriangleOnce) {
  for (const int count : {1, 2, 5, 1000, 20000}) {
    Scene scene = empty_scene();
    place(scene, random_triangles(count, 5, .3F, 7));
    check(build_bvh(scene), static_cast<std::size_t>(count));
  }
}

TEST(Bvh, IsEmptyWithoutTriangles) {
  EXPECT_TRUE(build_bvh(empty_scene()).nodes.empty());
  Scene scene = empty_scene();
  place(scene, quad({0, 0, 0}, {1, 0, 0}, {1, 0, 0}));
  EXPECT_TRUE(build_bvh(scene).nodes.empty()) << "zero area";
}

TEST(Bvh, LeavesOutWhatIsNotFinite) {
  Scene scene = empty_scene();
  Primitive primitive = random_triangles(10, 5, .3F, 7);
  primitive.positions[0].x = std::numeric_limits<float>::quiet_NaN();
  primitive.positions[4].y = std::numeric_limits<float>::infinity();
  place(scene, primitive);
  check(build_bvh(scene), 8);
}

TEST(Bvh, CopesWithDuplicatesAndExtremeSpread) {
  Scene scene = empty_scene();
  Primitive same;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    for (const glm::vec3 p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}) same.positions.push_back(p);
    for (std::uint32_t k = 0; k < 3; ++k) same.indices.push_back(3 * i + k);
  }
  place(scene, same);
  check(build_bvh(scene), 5000);
  // Each triangle twice as far as the one before: the splits that cost least peel them off one by one.
  Scene spread = empty_scene();
  for (int i = -60; i < 60; ++i) {
    const float s = std::exp2(static_cast<float>(i));
    for (int copy = 0; copy < 8; ++copy) place(spread, quad({s, 0, 0}, {.1F * s, 0, 0}, {0, .1F * s, 0}));
  }
  check(build_bvh(spread), 120 * 8 * 2);
}

TEST(Bvh, IsTheSameEachTime) {
  Scene scene = empty_scene();
  place(scene, random_triangles(20000, 5, .3F, 7));
  const Bvh a = build_bvh(scene);
  const Bvh b = build_bvh(scene);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    ASSERT_EQ(bits(a.nodes[i].lower.w), bits(b.nodes[i].lower.w));
    ASSERT_EQ(glm::vec3(a.nodes[i].lower), glm::vec3(b.nodes[i].lower));
  }
}

}  // namespace
}  // namespace loom::scene
