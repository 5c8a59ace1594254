// One mesh in every encoding: the same surface, to the precision that each of them keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "files.h"
#include "scene/bounds.h"
#include "scene/load.h"

namespace {

using loom::scene::Primitive;
using loom::scene::Scene;

struct Measures {
  std::size_t triangles = 0;
  double area = 0;
  double volume = 0;
  glm::dvec3 centroid{0};
  double normals = 0;  ///< mean of shading normal · face normal, weighted by area
  loom::scene::Box box;
};

Measures measure(const Scene& scene) {
  Measures m;
  m.box = scene_box(scene);
  for (const loom::scene::Instance& instance : scene.instances) {
    const glm::dmat3 linear(instance.world);
    const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(linear));
    for (const Primitive& p : scene.meshes.at(static_cast<std::size_t>(instance.mesh)).primitives) {
      m.triangles += p.indices.size() / 3;
      for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        glm::dvec3 corner[3];
        glm::dvec3 shading(0);
        for (std::size_t c = 0; c < 3; ++c) {
          corner[c] = glm::dvec3(instance.world * glm::dvec4(glm::dvec3(p.positions[p.indices[i + c]]), 1));
          shading += glm::normalize(normal_matrix * glm::dvec3(p.normals[p.indices[i + c]]));
        }
        const glm::dvec3 twice = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double area = .5 * glm::length(twice);
        m.area += area;
        m.volume += glm::dot(corner[0], glm::cross(corner[1], corner[2])) / 6;
        m.centroid += area * (corner[0] + corner[1] + corner[2]) / 3.0;
        m.normals += area > 0 ? .5 * glm::dot(glm::normalize(shading), twice) : 0;
      }
    }
  }
  m.centroid /= m.area;
  m.normals /= m.area;
  return m;
}

Measures load(const std::filesystem::path& file) {
  loom::Diagnostics diagnostics;
  return measure(loom::scene::load_gltf(file.string(), diagnostics));
}

class Encodings : public testing::TestWithParam<const char*> {};

TEST_P(Encodings, AgreeWithThePlainFile) {
  const std::filesystem::path folder = loom::test::scenes_folder() / "gltf-features/bunny-encodings";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "absent: $LOOM_SCENES/gltf-features/bunny-encodings";
  const Measures plain = load(folder / "bunny-interleaved.glb");
  const Measures other = load(folder / (std::string("bunny-") + GetParam() + ".glb"));
  // All keep positions to 14 bits of the 500 units that the bunny is wide: half a step is .015.
  constexpr double step = 500.0 / (1 << 14);
  EXPECT_EQ(other.triangles, plain.triangles);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(other.box.low[axis], plain.box.low[axis], step);
    EXPECT_NEAR(other.box.high[axis], plain.box.high[axis], step);
    EXPECT_NEAR(other.centroid[axis], plain.centroid[axis], step);
  }
  EXPECT_NEAR(other.area / plain.area, 1, 1e-3);
  EXPECT_NEAR(other.volume / plain.volume, 1, 1e-3);
  // Normals of 8 bits and more are off by less than half a degree on the mean.
  EXPECT_GT(plain.normals, .95);
  EXPECT_NEAR(other.normals, plain.normals, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Bunny, Encodings, testing::Values("quantized", "meshopt", "draco"));

}  // namespace
