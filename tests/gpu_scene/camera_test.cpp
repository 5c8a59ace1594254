#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

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

constexpr Box box{.low = {-4, -3, -20}, .high = {5, 6, 7}};

struct Ray {
  glm::dvec3 origin, direction;
};

/// As interop/camera.h has it, in double.
Ray ray_of(const interop::Camera& camera, glm::dvec2 p) {
  const glm::dvec2 s = 2. * p - 1. + glm::dvec2(camera.right.w, camera.up.w);
  const glm::dvec3 shift = s.x * glm::dvec3(camera.right) + s.y * glm::dvec3(camera.up);
  if (camera.eye.w > .5F) return {glm::dvec3(camera.eye) + shift, glm::dvec3(camera.forward)};
  return {glm::dvec3(camera.eye), glm::normalize(glm::dvec3(camera.forward) + shift)};
}

glm::dvec3 to_image(const interop::Camera& camera, glm::dvec3 point) {
  const glm::dvec4 clip = glm::dmat4(camera.view_proj) * glm::dvec4(point, 1);
  return {.5 * (glm::dvec2(clip) / clip.w + 1.), clip.z / clip.w};
}

Camera tilted(bool orthographic) {
  Camera camera;
  camera.eye = {1, 2, 6};
  camera.target = {-.5, 1, -3};
  camera.up = {.2, 1, .1};
  camera.orthographic = orthographic;
  camera.ymag = 3;
  camera.xmag = 0;
  return camera;
}

class CameraBlock : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Projections, CameraBlock, ::testing::Bool(),
                         [](const auto& projection) { return projection.param ? "Orthographic" : "Perspective"; });

TEST_P(CameraBlock, RaysMeetThePixelsTheyAreMeantFor) {
  for (const glm::dvec2 jitter : {glm::dvec2(0), glm::dvec2(.3, -.45)}) {
    const interop::Camera camera = make_camera(tilted(GetParam()), box, {320, 200}, jitter);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 1000; ++i) {
      const glm::dvec2 p(unit(random), unit(random));
      const Ray ray = ray_of(camera, p);
      const glm::dvec3 image = to_image(camera, ray.origin + (.1 + 10 * unit(random)) * ray.direction);
      // view_proj is rounded to float: 2⁻²⁴ of coordinates up to 10, over the half-width of the image.
      EXPECT_NEAR(image.x, p.x, 5e-6);
      EXPECT_NEAR(image.y, p.y, 5e-6);
    }
  }
}

TEST_P(CameraBlock, JitterMovesTheSamplesByPixels) {
  const glm::ivec2 size(320, 200);
  const interop::Camera still = make_camera(tilted(GetParam()), box, size);
  const glm::dvec2 jitter(.25, -.5);
  const interop::Camera moved = make_camera(tilted(GetParam()), box, size, jitter);
  const glm::dvec2 p(.3, .8);
  const Ray a = ray_of(still, p + jitter / glm::dvec2(size));
  const Ray b = ray_of(moved, p);
  EXPECT_LT(glm::distance(a.origin, b.origin), 1e-6);
  EXPECT_LT(glm::distance(a.direction, b.direction), 1e-7);
  EXPECT_EQ(still.eye, moved.eye);
  EXPECT_EQ(still.right.x, moved.right.x);
  EXPECT_EQ(glm::vec3(still.forward), glm::vec3(moved.forward));
}

TEST_P(CameraBlock, DepthIsReversed) {
  Camera description = tilted(GetParam());
  description.znear = .25;
  const interop::Camera camera = make_camera(description, box, {64, 64});
  const auto depth_at = [&](double distance) {
    return to_image(camera, description.eye + distance * glm::dvec3(camera.forward)).z;
  };
  EXPECT_NEAR(depth_at(.25), 1, 1e-5);
  EXPECT_GT(depth_at(1), depth_at(2));
  if (GetParam()) {
    // Every corner of the scene lies before the far plane.
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner((i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                              (i & 4) != 0 ? box.high.z : box.low.z);
      EXPECT_GT(to_image(camera, corner).z, 0);
    }
  } else {
    EXPECT_NEAR(depth_at(1e6), .25e-6, 1e-9);
  }
}

TEST_P(CameraBlock, AxesAreOrthogonalAndSized) {
  Camera description = tilted(GetParam());
  const interop::Camera camera = make_camera(description, box, {300, 150});
  const glm::dvec3 right(camera.right);
  const glm::dvec3 up(camera.up);
  const glm::dvec3 forward(camera.forward);
  EXPECT_NEAR(glm::length(forward), 1, 1e-7);
  EXPECT_NEAR(glm::dot(right, up), 0, 1e-6);
  EXPECT_NEAR(glm::dot(right, forward), 0, 1e-6);
  EXPECT_GT(glm::dot(glm::cross(right, up), -forward), 0);  // x right, y up, z towards the viewer
  EXPECT_GT(glm::dot(up, description.up), 0);
  const double half = GetParam() ? 3 : std::tan(.5 * description.yfov_rad);
  EXPECT_NEAR(glm::length(up), half, 1e-6);
  EXPECT_NEAR(glm::length(right), 2 * half, 1e-6);
  EXPECT_EQ(camera.size, glm::vec4(300, 150, 1.F / 300, 1.F / 150));
}

TEST(CameraBlockDefaults, NearPlaneFollowsTheScene) {
  const interop::Camera camera = make_camera(Camera{}, box, {8, 8});
  EXPECT_FLOAT_EQ(camera.proj[3][2], static_cast<float>(1e-4 * box.diagonal()));
}

TEST(CameraBlockDefaults, DegenerateViewsAreStillViews) {
  Camera straight_down;
  straight_down.eye = {0, 5, 0};
  straight_down.target = {0, 0, 0};
  Camera nowhere;
  nowhere.target = nowhere.eye;
  for (const Camera& description : {straight_down, nowhere}) {
    const interop::Camera camera = make_camera(description, Box{}, {8, 8});
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) EXPECT_TRUE(std::isfinite(camera.view_proj[c][r]));
    }
    EXPECT_NEAR(glm::length(glm::vec3(camera.forward)), 1, 1e-6);
    EXPECT_GT(glm::length(glm::vec3(camera.right)), .1F);
  }
}

TEST(CameraBlockDefaults, OrthographicWidthIsKeptWhereGiven) {
  Camera camera = tilted(true);
  camera.xmag = 1.5;
  const interop::Camera block = make_camera(camera, box, {200, 100});
  EXPECT_NEAR(glm::length(glm::vec3(block.right)), 1.5, 1e-6);
  EXPECT_NEAR(glm::length(glm::vec3(block.up)), 3, 1e-6);
}

}  // namespace
}  // namespace loom::scene
