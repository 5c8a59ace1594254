// The shaders' ray queries against every triangle in turn (in double) and against Embree.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "loom/gpu.h"
#include "loom/scene_view.h"
#include "scene/bvh.h"
#include "scene/gpu_scene.h"
#include "scene/scene.h"
#include "scene/world.h"
#include "support/gl.h"
#include "support/hand_scene.h"
#include "support/run_compute.h"

namespace loom::scene {
namespace {

using test::add_material;
using test::empty_scene;
using test::place;
using test::quad;
using test::random_triangles;

struct Ray {
  glm::vec4 origin;     ///< w: t_max
  glm::vec4 direction;  ///< w: 0
};
struct Answer {
  float t = 0;
  std::uint32_t triangle = 0;
  std::uint32_t hit = 0, occluded = 0;
  glm::vec4 position, normal, albedo;
};

const char* const shader = R"(
#include "lib/trace.glsl"
layout(local_size_x = 64) in;
struct Ray { vec4 origin, direction; };
struct Answer { float t; uint triangle, hit, occluded; vec4 position, normal, albedo; };
layout(std430) readonly buffer rays_block { Ray rays[]; };
layout(std430) writeonly buffer answers_block { Answer answers[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= rays.length()) return;
  vec3 origin = rays[i].origin.xyz, direction = rays[i].direction.xyz;
  float t_max = rays[i].origin.w;
  Hit hit = closest_hit(origin, direction, t_max);
  answers[i].t = hit.t;
  answers[i].triangle = hit.triangle;
  answers[i].hit = is_hit(hit) ? 1u : 0u;
  answers[i].occluded = occluded(origin, direction, t_max) ? 1u : 0u;
  answers[i].position = vec4(hit_position(hit), 1);
  answers[i].normal = vec4(hit_normal(hit), 0);
  answers[i].albedo = vec4(hit_albedo(hit), 0);
}
)";

class Trace : public test::GlTest {
 protected:
  std::vector<Answer> trace(const Scene& scene, const std::vector<Ray>& rays) const {
    const auto gpu = GpuScene::create(scene);
    write_shader("trace_test.comp", shader);
    const auto device = make_device();
    const auto program = device->program({.files = {"trace_test.comp"}, .defines = scene_defines(gpu->facts())});
    const Buffer in = Buffer::of(std::span<const Ray>(rays), "rays");
    const Buffer out(rays.size() * sizeof(Answer), "answers");
    test::run_compute(*program, *gpu, {{"rays_block", &in}, {"answers_block", &out}},
                      static_cast<unsigned int>((rays.size() + 63) / 64));
    std::vector<Answer> answers(rays.size());
    out.read(std::as_writable_bytes(std::span(answers)));
    return answers;
  }
};

std::vector<Ray> random_rays(std::size_t count, float extent, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const glm::vec3 d(unit(random), unit(random), unit(random));
    if (glm::length(d) > 1 || glm::length(d) < .01F) continue;
    const glm::vec3 o = extent * glm::vec3(unit(random), unit(random), unit(random));
    rays.push_back({glm::vec4(o, 1e30F), glm::vec4(glm::normalize(d), 0)});
  }
  // Along the axes, from lattice points: components that are zero, origins that lie on box planes.
  for (std::size_t i = 0; i < count / 8; ++i) {
    glm::vec3 d(0);
    d[static_cast<glm::length_t>(i % 3)] = (i & 1U) != 0 ? 1.F : -1.F;
    if (i % 5 == 0) d[static_cast<glm::length_t>((i + 1) % 3)] = -1;
    rays[i].direction = glm::vec4(d, 0);
  }
  return rays;
}

/// What is true of a ray, and whether rounding may decide otherwise.
struct Truth {
  bool hit = false;
  bool unsure = false;  ///< passes within 1e-5 of a triangle's edge, its plane, or its own limit
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = 0;
};

Truth brute_force(const Bvh& bvh, const Ray& ray) {
  Truth truth;
  const glm::dvec3 o(ray.origin);
  const glm::dvec3 d(ray.direction);
  for (std::uint32_t i = 0; i < bvh.triangles.size(); ++i) {
    const glm::dvec3 a = glm::dvec3(bvh.triangles[i].a) - o;
    const glm::dvec3 b = glm::dvec3(bvh.triangles[i].b) - o;
    const glm::dvec3 c = glm::dvec3(bvh.triangles[i].c) - o;
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double facing = glm::dot(n, d);
    const std::array<double, 3> w{glm::dot(glm::cross(b, c), d), glm::dot(glm::cross(c, a), d),
                                  glm::dot(glm::cross(a, b), d)};
    const double sum = w[0] + w[1] + w[2];
    const double low = std::min({w[0], w[1], w[2]}) / (sum != 0 ? std::abs(sum) : 1) * (sum < 0 ? -1 : 1);
    const double least = sum < 0 ? -std::max({w[0], w[1], w[2]}) / -sum : low;
    const double t = glm::dot(n, a) / facing;
    const bool edge_on = std::abs(facing) < 1e-4 * glm::length(n);
    if (edge_on || std::abs(least) < 1e-5 || std::abs(t) < 1e-5)
      truth.unsure = truth.unsure || least > -1e-5 || edge_on;
    if (least >= 0 && t > 0 && t < static_cast<double>(ray.origin.w)) {
      truth.hit = true;
      if (t < truth.t) {
        truth.t = t;
        truth.triangle = i;
      }
    }
  }
  return truth;
}

TEST_F(Trace, AgreesWithEveryTriangleInTurn) {
  Scene scene = empty_scene();
  place(scene, random_triangles(300, 4, .8F, 3));
  const std::vector<Ray> rays = random_rays(2000, 5, 5);
  const auto answers = trace(scene, rays);
  const Bvh bvh = build_bvh(scene);
  int unsure = 0;
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Truth truth = brute_force(bvh, rays[i]);
    unsure += truth.unsure ? 1 : 0;
    if (truth.unsure) continue;
    ASSERT_EQ(answers[i].hit != 0, truth.hit) << i;
    ASSERT_EQ(answers[i].occluded != 0, truth.hit) << i;
    if (!truth.hit) continue;
    ++hits;
    ASSERT_EQ(answers[i].triangle, truth.triangle) << i;
    ASSERT_NEAR(answers[i].t, truth.t, 1e-4 * truth.t) << i;
  }
  EXPECT_GT(hits, 300);
  EXPECT_LT(unsure, 400);
}

class Embree {
 public:
  explicit Embree(const Bvh& bvh) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * bvh.triangles.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, bvh.triangles.size()));
    std::uint32_t next = 0;
    for (const interop::BvhTriangle& t : bvh.triangles) {
      for (const glm::vec4& corner : {t.a, t.b, t.c}) {
        for (int k = 0; k < 3; ++k) *corners++ = corner[k];
        *indices++ = next++;
      }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  [[nodiscard]] bool occluded(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay r{};
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tfar = ray.origin.w;
    r.mask = ~0U;
    rtcOccluded1(scene_, &context, &r);
    return r.tfar < 0;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

TEST_F(Trace, AgreesWithEmbree) {
  Scene scene = empty_scene();
  place(scene, random_triangles(20000, 4, .1F, 11));
  std::vector<Ray> rays = random_rays(8192, 5, 13);
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i].origin.w = i % 2 == 0 ? 1e30F : 2.F;
  const auto answers = trace(scene, rays);
  const Bvh bvh = build_bvh(scene);
  const Embree embree(bvh);
  int different = 0;
  int blocked = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    blocked += answers[i].occluded != 0 ? 1 : 0;
    if ((answers[i].occluded != 0) == embree.occluded(rays[i])) continue;
    // The two may differ where a ray runs along an edge, nowhere else.
    EXPECT_TRUE(brute_force(bvh, rays[i]).unsure) << i;
    ++different;
  }
  EXPECT_GT(blocked, 1000);
  EXPECT_LT(blocked, 8000);
  EXPECT_LE(different, 3);
}

TEST_F(Trace, NothingLeaksBetweenTriangles) {
  // A finely tessellated closed sphere, rays from inside aimed at its vertices and edges.
  Scene scene = empty_scene();
  Primitive sphere;
  constexpr int rings = 24;
  constexpr int sectors = 48;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j <= sectors; ++j) {
      const double theta = std::acos(-1.) * i / rings;
      const double phi = 2 * std::acos(-1.) * (j % sectors) / sectors;
      sphere.positions.emplace_back(glm::dvec3(100.3, -7.7, 3.1) + glm::dvec3(std::sin(theta) * std::cos(phi),
                                                                              std::cos(theta),
                                                                              std::sin(theta) * std::sin(phi)));
      sphere.normals.emplace_back(0, 1, 0);
    }
  }
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(i * (sectors + 1) + j); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      for (const std::uint32_t index :
           {at(i, j), at(i + 1, j), at(i, j + 1), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)}) {
        sphere.indices.push_back(index);
      }
    }
  }
  place(scene, sphere);
  std::vector<Ray> rays;
  const glm::vec3 eye(100.5F, -7.5F, 3.2F);
  for (std::size_t i = 0; i + 1 < sphere.indices.size(); ++i) {
    const glm::vec3 a = sphere.positions[sphere.indices[i]];
    const glm::vec3 b = sphere.positions[sphere.indices[i + 1]];
    for (const float share : {0.F, .5F, .3F}) {
      rays.push_back({glm::vec4(eye, 1e30F), glm::vec4(glm::mix(a, b, share) - eye, 0)});
    }
  }
  const auto answers = trace(scene, rays);
  std::size_t leaks = 0;
  for (const Answer& answer : answers) leaks += answer.hit == 0 || answer.occluded == 0 ? 1 : 0;
  EXPECT_EQ(leaks, 0U) << "of " << rays.size();
}

TEST_F(Trace, HitTellsPositionNormalAndAlbedo) {
  Scene scene = empty_scene();
  scene.images.push_back({.name = "half", .width = 2, .height = 1, .rgba = {255, 255, 255, 255, 0, 0, 0, 255}});
  const int wall =
      add_material(scene, {.base_color = {.8F, .4F, .2F, 1}, .metallic = .25F, .base_color_texture = {.image = 0}});
  // Front normal +z; mirrored in y it still faces +z.
  place(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, wall),
        glm::scale(glm::translate(glm::dmat4(1), {0, 0, -3}), {1, -1, 1}));
  const auto answers = trace(scene, {{{.25F, .5F, 1, 1e30F}, {0, 0, -1, 0}}, {{.25F, .5F, -9, 1e30F}, {0, 0, 2, 0}}});
  EXPECT_FLOAT_EQ(answers[0].t, 4);
  EXPECT_FLOAT_EQ(answers[1].t, 3);  // in lengths of the direction
  for (const Answer& answer : answers) {
    EXPECT_NEAR(glm::distance(glm::vec3(answer.position), glm::vec3(.25F, .5F, -3)), 0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::vec3(answer.normal), glm::vec3(0, 0, 1)), 0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::vec3(answer.albedo), .5F * .75F * glm::vec3(.8F, .4F, .2F)), 0, 1e-6);
  }
}

TEST_F(Trace, MaskedSurfacesAreCutOut) {
  Scene scene = empty_scene();
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 64; ++i) {
    const bool solid = i % 8 < 4;
    texels.insert(texels.end(), {255, 255, 255, static_cast<std::uint8_t>(solid ? 255 : 0)});
  }
  scene.images.push_back({.name = "halves", .width = 8, .height = 8, .rgba = texels});
  const TextureRef repeated{.image = 0};
  const TextureRef clamped{.image = 0, .repeat_u = false, .repeat_v = false};
  const TextureRef twice{.image = 0, .transform = {2, 0, 0, 2, 0, 0}};
  const int factor_only = add_material(scene, {.base_color = {1, 1, 1, .3F}, .alpha = AlphaMode::mask});
  const std::array<int, 3> materials{add_material(scene, {.alpha = AlphaMode::mask, .base_color_texture = repeated}),
                                     add_material(scene, {.alpha = AlphaMode::mask, .base_color_texture = clamped}),
                                     add_material(scene, {.alpha = AlphaMode::mask, .base_color_texture = twice})};
  for (std::size_t i = 0; i < materials.size(); ++i) {
    place(scene, quad({0, 2 * static_cast<float>(i), 0}, {1, 0, 0}, {0, 1, 0}, materials[i]));
  }
  place(scene, quad({0, 6, 0}, {1, 0, 0}, {0, 1, 0}, factor_only));
  Primitive faded = quad({0, 8, 0}, {1, 0, 0}, {0, 1, 0}, materials[1]);
  faded.colors = {{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}};  // alpha falls with height
  place(scene, faded);
  const auto ray = [](float x, float y) { return Ray{{x, y, 1, 1e30F}, {0, 0, -1, 0}}; };
  const auto answers = trace(scene, {ray(.25F, .5F), ray(.75F, .5F),    // repeated: left solid
                                     ray(.02F, 2.5F), ray(.98F, 2.5F),  // clamped: no bleeding at the edge
                                     ray(.125F, 4.5F), ray(.375F, 4.5F), ray(.625F, 4.5F), ray(.875F, 4.5F),  // twice
                                     ray(.25F, 6.5F), ray(.25F, 8.25F), ray(.25F, 8.75F)});
  const std::vector<int> expected{1, 0, 1, 0, 1, 0, 1, 0, 0, 1, 0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(static_cast<int>(answers[i].occluded), expected[i]) << i;
    EXPECT_EQ(static_cast<int>(answers[i].hit), expected[i]) << i;
  }
}

}  // namespace
}  // namespace loom::scene
