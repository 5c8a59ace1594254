// shaders/lib/sampling.glsl: nets, hemispheres, seeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/gpu.h"
#include "scene/gpu_scene.h"
#include "support/gl.h"
#include "support/hand_scene.h"
#include "support/run_compute.h"

namespace loom {
namespace {

const char* const shader = R"(
#include "lib/sampling.glsl"
layout(local_size_x = 64) in;
uniform uint seed;
layout(std430) writeonly buffer points_block { vec4 points[]; };
layout(std430) writeonly buffer directions_block { vec4 directions[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  vec2 u = low_discrepancy(i, pixel_seed(uvec2(3, 5), uvec4(seed, 0, 0, 1), 0u));
  points[i] = vec4(u, uniform_triangle(u));
  directions[i] = vec4(cosine_hemisphere(u, normalize(vec3(1, -2, -3))), 0);
}
)";

constexpr unsigned int count = 1024;

class Sampling : public test::GlTest {
 protected:
  void sample(unsigned int seed) {
    write_shader("sampling_test.comp", shader);
    const auto device = make_device();
    const auto program = device->program({.files = {"sampling_test.comp"}});
    const scene::Scene nothing = test::empty_scene();
    const auto gpu = scene::GpuScene::create(nothing);
    const Buffer points(count * sizeof(glm::vec4), "points");
    const Buffer directions(count * sizeof(glm::vec4), "directions");
    program->set("seed", seed);
    test::run_compute(*program, *gpu, {{"points_block", &points}, {"directions_block", &directions}}, count / 64);
    points_.resize(count);
    directions_.resize(count);
    points.read(std::as_writable_bytes(std::span(points_)));
    directions.read(std::as_writable_bytes(std::span(directions_)));
  }

  std::vector<glm::vec4> points_, directions_;
};

TEST_F(Sampling, EveryPowerOfTwoIsANet) {
  sample(1);
  for (unsigned int k = 0; k <= 10; ++k) {
    const unsigned int n = 1U << k;
    for (unsigned int start = 0; start + n <= count; start += n) {
      for (unsigned int a = 0; a <= k; ++a) {
        const unsigned int columns = 1U << a;
        const unsigned int rows = n / columns;
        std::vector<int> boxes(n);
        for (unsigned int i = start; i < start + n; ++i) {
          ASSERT_LT(points_[i].x, 1);
          ASSERT_LT(points_[i].y, 1);
          ++boxes[static_cast<unsigned int>(points_[i].x * static_cast<float>(columns)) * rows +
                  static_cast<unsigned int>(points_[i].y * static_cast<float>(rows))];
        }
        ASSERT_TRUE(std::all_of(boxes.begin(), boxes.end(), [](int b) { return b == 1; })) << n << " from " << start;
      }
    }
  }
}

TEST_F(Sampling, SeedsDecideAllAndAreIndependent) {
  sample(1);
  const std::vector<glm::vec4> first = points_;
  sample(1);
  EXPECT_EQ(points_, first);
  sample(2);
  double covariance = 0;
  for (unsigned int i = 0; i < count; ++i) {
    covariance += static_cast<double>((points_[i].x - .5F) * (first[i].x - .5F)) / count;
  }
  // Of independent points: 1/12 over the root of their number, four deviations.
  EXPECT_LT(std::abs(covariance), 4. / 12 / std::sqrt(count));
}

TEST_F(Sampling, HemisphereIsCosineWeightedAboutItsAxis) {
  sample(3);
  const glm::dvec3 n = glm::normalize(glm::dvec3(1, -2, -3));
  glm::dvec3 mean(0);
  double mean_square = 0;
  for (const glm::vec4& d : directions_) {
    const glm::dvec3 direction(d);
    EXPECT_NEAR(glm::length(direction), 1, 1e-6);
    EXPECT_GE(glm::dot(direction, n), -1e-6);
    mean += direction / static_cast<double>(count);
    mean_square += std::pow(glm::dot(direction, n), 2) / count;
  }
  // ∫cos²/π = 2/3 along n, nothing across it; ∫cos³/π = 1/2. A net of 1024 points is within about 1/1024.
  EXPECT_LT(glm::distance(mean, 2. / 3 * n), 4. / count);
  EXPECT_NEAR(mean_square, .5, 2. / count);
}

TEST_F(Sampling, TriangleIsCoveredEvenly) {
  sample(4);
  glm::dvec2 mean(0);
  for (const glm::vec4& p : points_) {
    EXPECT_GE(p.z, 0);
    EXPECT_GE(p.w, 0);
    EXPECT_LE(p.z + p.w, 1 + 1e-6);
    mean += glm::dvec2(p.z, p.w) / static_cast<double>(count);
  }
  EXPECT_NEAR(mean.x, 1. / 3, 2. / count);
  EXPECT_NEAR(mean.y, 1. / 3, 2. / count);
}

}  // namespace
}  // namespace loom
